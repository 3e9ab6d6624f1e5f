#include "mbk/experiment/session/session.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/version.h"
#include "mbk/base/realtime/signal_stack.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/write.h"
#include "mbk/files/recording/write_file.h"

namespace mbk::session {
namespace {

namespace fs = std::filesystem;
using journal::Header;
using journal::Tick;

/// Two seconds at 1 kHz: longer than any stall that a machine fit for this work has.
constexpr std::size_t kRing = 4096;

std::string now_text() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

journal::Ending ending_of(const TrialOutcome& outcome, const LoopFlags& flags) {
  journal::Ending ending;
  using How = journal::Ending::How;
  const bool tripped = outcome.trip.reason != safety::Reason::none;
  ending.how = tripped ? How::safety_stop : flags.end_trial ? How::ended_early : How::completed;
  if (tripped) {
    ending.detail = safety::sentence(outcome.trip);
    ending.trip = word_of(outcome.trip.reason);
  }
  ending.motors = safety::sentence(outcome.motors);
  ending.overruns = outcome.times.missed;
  ending.ticks = outcome.times.ticks;
  return ending;
}

/// Starts the robot, and looks at its stop button before anything moves.
Result<void> start(device::Device& robot) {
  MBK_TRY(robot.start());
  device::State state;
  robot.read(state);
  if (!state.stop) return {};
  robot.stop();
  return bad_usage(fmt::format("{}: the stop button is pressed", robot.facts().name), "release it, then start again");
}

/// To the bit, but that one NaN is as good as another.
bool same(const Vector& one, const Vector& other) {
  const auto equal = [](double a, double b) {
    return std::isnan(a) ? std::isnan(b) : std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  };
  return one.size() == other.size() && std::equal(one.begin(), one.end(), other.begin(), equal);
}

/// Whether `there` is the recording. A channel that is NaN throughout may be left out, as MAT files do.
bool holds_the_same(const Recording& there, const Recording& recording) {
  if (!same(there.time, recording.time) || there.events.size() != recording.events.size()) return false;
  for (const char* key : {"ended", "ticks_lost", "gaps"}) {
    const auto value = recording.metadata.find(key), twin = there.metadata.find(key);
    if (value != recording.metadata.end() && (twin == there.metadata.end() || *twin != *value)) return false;
  }
  return std::ranges::all_of(recording.channels, [&](const Channel& channel) {
    const Channel* const twin = there.find(channel.name);
    return twin != nullptr ? same(twin->values, channel.values) : channel.values.array().isNaN().all();
  });
}

/// What the file holds, if that is the recording.
std::optional<Recording> read_back(const fs::path& target, const Recording& recording) {
  std::error_code ignored;
  if (!fs::exists(target, ignored)) return std::nullopt;
  auto there = recording::read(target, {});
  if (!there || !holds_the_same(*there, recording)) return std::nullopt;
  return std::move(*there);
}

std::string one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return printable(std::move(text));
}

void add_notes(const std::vector<std::string>& notes, std::map<std::string, std::string>& metadata) {
  if (notes.empty()) return;
  std::string& text = metadata["notes"];
  for (const std::string& note : notes) text += (text.empty() ? "" : " | ") + one_line(note);
}

/// Writes the recording anew with the metadata as `change` leaves them.   @fails  as recording::read and write
template <class Change>
Result<void> change_metadata(const fs::path& file, const Change& change) {
  auto recording = recording::read(file, {});
  if (!recording) return tl::unexpected(recording.error());
  const auto format = MBK_TRY(recording::format_of(file));
  change(recording->metadata);
  return recording::write(*recording, file, format, true, recording::readers_of(file));
}

std::uint64_t expected_ticks(const Plan& plan) {
  return static_cast<std::uint64_t>(plan.sequence.duration(0.5) / plan.sample_time());
}

/// Closes the journal and makes the recording of it. What fails is in the outcome beside how the trial ended.
void make_recording(Recorder& recorder, TrialOutcome& outcome) {
  const auto closed = recorder.finish(outcome.ending);
  outcome.journal = recorder.journal();
  outcome.ended = outcome.ending.word();
  const auto unrecorded = [&](Error error, std::string_view remedy) {
    error.remedy = fmt::format("{}run 'mbk recover {}'", remedy, outcome.journal.string());
    outcome.unrecorded = std::move(error);
    outcome.incomplete = true;
  };
  if (!closed) return unrecorded(closed.error(), "free space, then ");
  outcome.ending = *closed;
  std::error_code ignored;
  if (const fs::path folder = outcome.recording.parent_path(); !folder.empty() && !fs::exists(folder, ignored)) {
    outcome.recording = outcome.journal.parent_path() / outcome.journal.stem();  // where the journal was saved
  }
  auto recovered = recover(outcome.journal, outcome.recording, {.ending = outcome.ending, .notes = outcome.notes});
  if (!recovered) {
    const bool taken = fs::exists(outcome.recording, ignored);
    unrecorded(recovered.error(), taken ? "move that file away, then " : "check the folder and the disk, then ");
    return;
  }
  outcome.recorded = std::move(recovered->read_back);
  outcome.damage = recovered->damage;
  outcome.incomplete = recovered->incomplete || recovered->ticks != outcome.times.ticks;
  outcome.ended = recovered->recording.metadata.at("ended");
}

/// Until the loop has a thread: whatever is in the way leaves the robot stopped, and no journal without ticks.
struct NotBegun {
  fs::path journal;
  device::Device* robot = nullptr;  // once it was started
  bool begun = false;
  ~NotBegun() {
    if (begun) return;
    if (robot != nullptr) robot->stop();
    std::error_code ignored;
    fs::remove(journal, ignored);
  }
};

}  // namespace

Header header_of(const Plan& plan, const device::Facts& facts) {
  const protocol::Trial& trial = plan.trial;
  Header header;
  header.metadata = protocol::metadata_of(trial.person);
  // Who is simulated is at the handle only where the robot is simulated.
  if (trial.device.simulated() && trial.simulation) header.metadata.merge(trial.simulation->metadata(trial));
  header.metadata["protocol"] = trial.protocol;
  if (!trial.name.empty()) header.metadata["trial"] = trial.name;
  if (!trial.condition.empty()) header.metadata["condition"] = trial.condition;
  header.metadata["robot"] = facts.name;
  header.metadata["seed"] = std::to_string(trial.seed);
  header.metadata["handle_mass_kg"] = fmt::format("{:.12g}", trial.handle_mass);
  header.metadata["software"] = fmt::format("mbk {}", version());
  header.metadata["began"] = now_text();
  header.metadata["experiment_sha256"] = trial.file_sha256;
  header.metadata["safety_limits"] = safety::text_of(plan.limits);
  header.geometry = trial.robot.geometry;
  header.rate = trial.rate.value;
  header.readers = trial.readers;
  header.reference_unit = plan.schedule.quantity() == perturbation::Quantity::force ? "N" : "m";
  header.has_force = facts.has_force;
  header.has_acceleration = facts.has_acceleration;
  header.force_latency = facts.force_latency;
  for (const auto& event : plan.schedule.events()) header.events.push_back({event.time, event.name, event.value});
  return header;
}

Result<void> check_target(const Plan& plan, const fs::path& target) {
  MBK_TRY(recording::format_of(target));
  const auto can_write = [](const fs::path& file) -> Result<void> {
    auto ok = recording::can_write_file(file, false);
    if (!ok && ok.error().kind == ErrorKind::usage) ok.error().remedy = "choose another name, or move the file away";
    return ok;
  };
  MBK_TRY(can_write(target));
  const fs::path journal = journal_of(target);
  std::error_code ignored;
  if (fs::exists(journal, ignored)) return tl::unexpected(journal::Writer::already_there(journal));
  MBK_TRY(can_write(journal));
  constexpr std::uintmax_t kTickInRecording = 18 * sizeof(double), kMore = 16 << 20;  // channels and time; spare
  const std::uintmax_t needed = expected_ticks(plan) * (sizeof(Tick) * 11 / 10 + kTickInRecording) + kMore;
  const auto space = fs::space(target.has_parent_path() ? target.parent_path() : fs::path("."), ignored);
  if (ignored || space.available >= needed) return {};
  return bad_data(fmt::format("the disk has {} MB free; the trial needs {} MB", space.available >> 20U, needed >> 20U),
                  "free space, or record to another disk", target.string());
}

fs::path journal_of(const fs::path& recording) {
  return recording.string() + ".journal";
}

void Session::see_idle(const IdleState& state) {
  const std::scoped_lock lock(*gate_mutex_);
  if (gate_) gate_->see_idle(state.stop_button, state.confirmed_off);
}

Result<void> Session::reset() {
  const std::scoped_lock lock(*gate_mutex_);
  if (gate_) {
    MBK_TRY(gate_->reset());
  }
  flags_->operator_stop = false;
  flags_->stop_signal = 0;
  flags_->recording = true;
  return {};
}

Result<TrialOutcome> Session::perform(device::Device& robot, const Plan& plan, const fs::path& target,
                                      const Watch& watch, const Callbacks& callbacks) {
  const protocol::Trial& trial = plan.trial;
  if (trial.person.withdrawn) {
    return bad_usage("the participant has withdrawn, so no trial may start", "check [person] withdrawn");
  }
  if (gate_ && gate_->tripped()) {
    return bad_usage("the gate is tripped: " + safety::sentence(gate_->trip()), "clear the cause, then reset");
  }
  MBK_TRY(check_target(plan, target));
  if (pace_.virtual_clock && robot.facts().keeps_time && !trial.device.simulated()) {
    return bad_usage(fmt::format("{} keeps its own time and cannot follow a virtual clock", robot.facts().name),
                     "omit --fast and --speed; for a simulation behind UDP, set lock_step = true");
  }
  auto gate = MBK_TRY(plan.gate());
  const double sample_time = plan.sample_time();

  TrialOutcome outcome;
  outcome.recording = target;
  outcome.journal = journal_of(target);
  auto writer = MBK_TRY(journal::Writer::create(outcome.journal, header_of(plan, robot.facts()), expected_ticks(plan)));
  NotBegun guard{outcome.journal};
  const bool in_real_time = !pace_.virtual_clock && pace_.clock == nullptr;
  if (in_real_time) realtime::lock_memory();
  MBK_TRY(start(robot));
  guard.robot = &robot;

  gate_ = std::move(gate);
  control::Sequencer sequence = plan.sequence;
  flags_->end_trial = false;
  flags_->recording = true;
  flags_->silent = false;
  flags_->beats = 0;
  realtime::BoundedRing<Tick> ring(kRing);
  Recorder recorder(ring, std::move(writer), *flags_, watch, in_real_time);
  std::optional<LoopWatch> loop_watch;  // begun before the loop: a machine that has no thread for it moves nothing
  if (!trial.device.simulated()) {
    loop_watch.emplace(*flags_, robot.facts().keeps_time,
                       watched_loop(robot, recorder, callbacks, sample_time, outcome));
  }
  std::thread loop([&] {
    const realtime::SignalStack stack;
    if (pace_.clock != nullptr) {
      run_loop(robot, sequence, *gate_, *pace_.clock, ring, *flags_, outcome.times);
    } else if (pace_.virtual_clock) {
      realtime::VirtualClock clock(sample_time, pace_.speed);
      run_loop(robot, sequence, *gate_, clock, ring, *flags_, outcome.times);
    } else {
      outcome.setup = realtime::prepare_thread();
      realtime::WallClock clock(sample_time);
      run_loop(robot, sequence, *gate_, clock, ring, *flags_, outcome.times);
    }
  });
  guard.begun = true;
  loop.join();
  loop_watch.reset();
  if (!flags_->given_up()) conclude(recorder, callbacks, outcome);
  return outcome;
}

/// What the outcome does not say yet of trip and motors is what the gate says.
void Session::conclude(Recorder& recorder, const Callbacks& callbacks, TrialOutcome& outcome) const {
  if (outcome.trip.reason == safety::Reason::none) outcome.trip = gate_->trip();
  if (outcome.trip.reason == safety::Reason::operator_stop) outcome.trip.value = flags_->stop_signal;
  if (outcome.motors.state == safety::MotorsOff::State::not_asked) outcome.motors = gate_->motors();
  outcome.ending = ending_of(outcome, *flags_);
  if (callbacks.notes) outcome.notes = callbacks.notes();
  make_recording(recorder, outcome);
}

LoopWatch::Told Session::watched_loop(device::Device& robot, Recorder& recorder, const Callbacks& callbacks,
                                      double sample_time, TrialOutcome& outcome) const {
  using State = safety::MotorsOff::State;
  const auto motors_of = [](double silent, State state) {
    safety::MotorsOff motors;
    motors.state = state;
    motors.after = silent;
    motors.why = safety::MotorsOff::Why::no_tick;
    return motors;
  };
  const auto tell = [&callbacks](const safety::MotorsOff& motors) {
    if (callbacks.motors) callbacks.motors(motors);
  };
  return {[=](double silent) { tell(motors_of(silent, State::missing)); },
          [=](double silent) { tell(motors_of(silent, State::waiting)); },
          [=, this, &robot, &recorder, &callbacks, &outcome](double silent) {
            robot.emergency_off();
            if (!gate_->tripped()) {
              const double now = static_cast<double>(outcome.times.ticks) * sample_time;
              outcome.trip = {safety::Reason::loop_stalled, now, outcome.times.ticks, silent, LoopWatch::kLongest};
            }
            if (!gate_->settled()) outcome.motors = motors_of(silent, State::missing);
            conclude(recorder, callbacks, outcome);
            if (callbacks.given_up) callbacks.given_up(outcome);
          }};
}

Result<void> annotate(const fs::path& file, const std::vector<std::string>& notes) {
  return change_metadata(file, [&](auto& metadata) { add_notes(notes, metadata); });
}

Result<void> set_metadata(const fs::path& file, const std::map<std::string, std::string>& requested) {
  return change_metadata(file, [&](auto& metadata) {
    for (const auto& [key, text] : requested) {
      metadata.erase(key);
      if (!text.empty()) metadata[key] = one_line(text);
    }
  });
}

Result<Recovered> recover(const fs::path& file, const fs::path& target, const RecoverOptions& options) {
  if (const int process = journal::recorded_by(file); process != 0) {
    return fail(ErrorKind::usage, fmt::format("is being recorded by process {}", process),
                "wait until the trial ends; mbk then makes the recording automatically", file.string());
  }
  Recovered recovered;
  auto readers = options.readers;
  {
    auto journal = journal::read(file);  // gone before the recording is written: half a gigabyte for an hour
    if (!journal) return tl::unexpected(journal.error());
    if (options.ending) journal->end_with(*options.ending);
    auto made = journal::to_recording(*journal);
    if (!made) return tl::unexpected(made.error().in(file.string()));
    if (!readers) readers = journal->header.readers;
    add_notes(options.notes, made->metadata);
    recovered.ticks = journal->ticks.size();
    recovered.incomplete = journal->incomplete();
    recovered.damage = std::move(journal->damage);
    recovered.recording = std::move(*made);
  }
  const Recording& recording = recovered.recording;
  const auto format = MBK_TRY(recording::format_of(target));
  std::optional<Recording> there = options.overwrite ? std::nullopt : read_back(target, recording);
  if (!there) {
    MBK_TRY(recording::write(recording, target, format, options.overwrite, *readers));
    there = read_back(target, recording);
  }
  if (!there) {
    std::error_code ignored;
    fs::remove(target, ignored);
    return bad_data("the recording read back differently from what was written, and was removed",
                    fmt::format("check the disk, then run 'mbk recover {}'", file.string()), target.string());
  }
  recovered.read_back = std::move(*there);
  std::error_code failed;
  const bool pristine = !recovered.damage.any() && !recovered.incomplete;
  recovered.removed = pristine && !options.keep && fs::remove(file, failed);
  return recovered;
}

}  // namespace mbk::session
