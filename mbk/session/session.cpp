#include "mbk/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "mbk/core/printable.h"
#include "mbk/core/version.h"
#include "mbk/recording/read.h"
#include "mbk/recording/write.h"
#include "mbk/session/plan.h"

namespace mbk::session {
namespace {

namespace fs = std::filesystem;
using journal::Header;
using journal::Tick;

/// Two seconds at 1 kHz: longer than any stall that a machine fit for this work has.
constexpr std::size_t kRing = 4096;

std::string now_text() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                     utc.tm_hour, utc.tm_min, utc.tm_sec);
}

journal::Ending ending_of(const safety::Gate& gate, const Signals& signals, const LoopTimes& times) {
  journal::Ending ending;
  ending.how = gate.tripped() ? "safety stop" : signals.end_trial ? "ended early by the operator" : "completed";
  if (gate.tripped()) {
    ending.detail = safety::sentence(gate.trip());
    ending.trip = safety::code(gate.trip().reason);
  }
  ending.motors = safety::sentence(gate.motors());
  ending.overruns = times.missed;
  return ending;
}

/// Starts the robot, and looks at its stop button before anything moves.
Result<void> start(device::Device& robot) {
  if (auto ok = robot.start(); !ok) return ok;
  device::State state;
  robot.read(state);
  if (!state.stop) return {};
  robot.stop();
  return bad_usage(fmt::format("{}: the stop button is pressed", robot.facts().name), "release it, then begin again");
}

/// Whether the recording is there already and holds the same: the program went down before it removed the journal.
bool holds_the_same(const fs::path& target, const Recording& recording) {
  if (!fs::exists(target)) return false;
  const auto there = recording::read(target, {});
  if (!there || there->samples() != recording.samples() || there->time != recording.time) return false;
  return std::ranges::all_of(recording.channels, [&](const Channel& channel) {
    const Channel* const twin = there->find(channel.name);
    return twin != nullptr && twin->values == channel.values;
  });
}

}  // namespace

Header header_of(const Trial& trial, const device::Facts& facts, const perturbation::Schedule& schedule) {
  Header header;
  header.metadata = metadata_of(trial.person);
  // The scenario's participant is at the handle only where the robot is simulated.
  if (trial.device.simulated()) header.metadata.merge(laboratory::scenario_metadata(trial.scenario));
  header.metadata["protocol"] = trial.protocol;
  if (!trial.name.empty()) header.metadata["trial"] = trial.name;
  if (!trial.scenario.condition.empty()) header.metadata["condition"] = trial.scenario.condition;
  header.metadata["robot"] = facts.name;
  header.metadata["seed"] = std::to_string(trial.scenario.seed);
  header.metadata["handle_mass_kg"] = fmt::format("{:.12g}", trial.planar().robot.handle_mass);
  header.metadata["software"] = fmt::format("mbk {}", version());
  header.metadata["began"] = now_text();
  header.geometry = trial.planar().robot.robot.geometry;
  header.rate = trial.scenario.rate.value;
  header.reference_unit = schedule.quantity() == perturbation::Quantity::force ? "N" : "m";
  header.has_force = facts.has_force;
  header.has_acceleration = facts.has_acceleration;
  header.force_latency = facts.force_latency;
  for (const auto& event : schedule.events()) header.events.push_back({event.time, event.name, event.value});
  return header;
}

fs::path journal_of(const fs::path& recording) {
  return recording.string() + ".journal";
}

void Session::see_idle(const IdleState& state) {
  const std::scoped_lock lock(gate_mutex_);
  if (gate_) gate_->see_idle(state.stop_button, state.confirmed_off);
}

Result<void> Session::reset() {
  const std::scoped_lock lock(gate_mutex_);
  if (gate_) {
    if (auto ok = gate_->reset(); !ok) return ok;
  }
  signals_->operator_stop = false;
  signals_->recording = true;
  return {};
}

Result<TrialOutcome> Session::perform(device::Device& robot, const Trial& trial, const fs::path& target,
                                      const Watch& watch) {
  if (trial.person.withdrawn) {
    return bad_usage("the person has withdrawn: no further trial is begun", "see [person] withdrawn");
  }
  if (gate_ && gate_->tripped()) {
    return bad_usage("the gate is tripped: " + safety::sentence(gate_->trip()), "see to the reason, then reset");
  }
  if (fs::exists(target)) {
    return fail(ErrorKind::usage, "is there already", "choose another name, or move it away", target.string());
  }
  if (pace_.virtual_clock && robot.facts().keeps_time && !trial.device.simulated()) {
    return bad_usage(fmt::format("{} keeps its own time, which a virtual clock cannot hurry", robot.facts().name),
                     "run it without --fast and --speed; a simulation behind UDP can wait: lock_step = true");
  }
  auto plan = make_plan(trial);
  if (!plan) return tl::unexpected(plan.error());
  const double sample_time = 1.0 / trial.scenario.rate.value;

  TrialOutcome outcome;
  outcome.recording = target;
  outcome.journal = journal_of(target);
  const auto expected = static_cast<std::uint64_t>(plan->sequence.duration(0.5) / sample_time);
  auto writer = journal::Writer::create(outcome.journal, header_of(trial, robot.facts(), plan->schedule), expected);
  if (!writer) return tl::unexpected(writer.error());
  if (auto ok = start(robot); !ok) {
    std::error_code ignored;
    fs::remove(outcome.journal, ignored);
    return tl::unexpected(ok.error());
  }

  gate_ = std::move(plan->gate);
  signals_->end_trial = false;
  signals_->recording = true;
  realtime::BoundedRing<Tick> ring(kRing);
  Recorder recorder(ring, std::move(*writer), *signals_, watch);
  std::thread loop([&] {
    if (pace_.clock != nullptr) {
      run_loop(robot, plan->sequence, *gate_, *pace_.clock, ring, *signals_, outcome.times);
    } else if (pace_.virtual_clock) {
      realtime::VirtualClock clock(sample_time, pace_.speed);
      run_loop(robot, plan->sequence, *gate_, clock, ring, *signals_, outcome.times);
    } else {
      outcome.setup = realtime::prepare_thread();
      realtime::WallClock clock(sample_time);
      run_loop(robot, plan->sequence, *gate_, clock, ring, *signals_, outcome.times);
    }
  });
  loop.join();

  outcome.trip = gate_->trip();
  outcome.motors = gate_->motors();
  outcome.ending = ending_of(*gate_, *signals_, outcome.times);
  auto closed = recorder.finish(outcome.ending);
  outcome.ending.dropped = ring.dropped();
  if (!closed) {
    Error error = closed.error();
    if (gate_->tripped()) error.message += "; safety stop: " + outcome.ending.detail;
    error.remedy = fmt::format("free space, then 'mbk recover {}'", outcome.journal.string());
    return tl::unexpected(error);
  }
  if (auto recording = recover(outcome.journal, target, false, false); !recording) {
    return tl::unexpected(recording.error());
  }
  return outcome;
}

Result<void> annotate(const fs::path& file, const std::vector<std::string>& notes) {
  auto recording = recording::read(file, {});
  if (!recording) return tl::unexpected(recording.error());
  const auto format = recording::format_of(file);
  if (!format) return tl::unexpected(format.error());
  std::string& text = recording->metadata["notes"];
  for (std::string note : notes) {
    std::ranges::replace(note, '\n', ' ');
    text += (text.empty() ? "" : " | ") + printable(std::move(note));
  }
  return recording::write(*recording, file, *format, true);
}

Result<Recording> recover(const fs::path& file, const fs::path& target, bool overwrite, bool keep) {
  auto recording = [&]() -> Result<Recording> {
    const auto journal = journal::read(file);  // gone before the recording is written: half a gigabyte for an hour
    if (!journal) return tl::unexpected(journal.error());
    auto made = journal::to_recording(*journal);
    if (!made) return tl::unexpected(made.error().in(file.string()));
    return made;
  }();
  if (!recording) return tl::unexpected(recording.error());
  const auto format = recording::format_of(target);
  if (!format) return tl::unexpected(format.error());
  if (overwrite || !holds_the_same(target, *recording)) {
    if (auto ok = recording::write(*recording, target, *format, overwrite); !ok) return tl::unexpected(ok.error());
  }
  if (!keep) {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
  return recording;
}

}  // namespace mbk::session
