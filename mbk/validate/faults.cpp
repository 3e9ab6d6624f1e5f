#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "mbk/base/numeric/statistics.h"
#include "mbk/base/realtime/clock.h"
#include "mbk/base/system/temporary_folder.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/session.h"
#include "mbk/files/journal/journal.h"
#include "mbk/files/journal/tick.h"
#include "mbk/files/recording/read.h"
#include "mbk/simulate/laboratory/ready_scenarios.h"
#include "mbk/simulate/laboratory/simulation.h"
#include "mbk/validate/each_run.h"
#include "mbk/validate/fault_kinds.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

namespace fs = std::filesystem;
using safety::Reason;

/// Ticks are recorded by a thread of its own: where the robot does not wait for it, time has to have a pace.
constexpr double kPace = 20.0;

/// The gate knows the angles of the tick's beginning, in counts of the encoder: what a hand at full speed turns in a
/// tick, and a count, are the difference [N].
constexpr double kForceTolerance = 0.05;

/// Maximum speed of the hand before the stop if the motors are reversed in a position trial [m/s].
constexpr double kRunawaySpeed = 0.4;
constexpr std::string_view kWrongWay = "motors reversed";

/// The robot is found so far from the test location [m].
constexpr double kAway = 0.015;

constexpr std::array kTrialKinds = {TrialKind::position, TrialKind::force};

/// What became of one run.
struct Outcome {
  int ticks = -1;  ///< from the onset to motors that are off and stay so; −1: never
  Reason reason = Reason::none;
  double handle_force = 0.0;  ///< largest that was commanded, by the true angles [N]
  double speed = 0.0;         ///< largest of the hand since the onset, by the true angles [m/s]
  bool recorded = false;      ///< the recording opens and holds every command to the bit
};

std::int64_t draw_onset(const FaultKind& kind, int detection, numeric::Random& random) {
  const auto between = [&](int low, int high) {
    return low + static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(high - low)));
  };
  const int latest = kTrialEnds - detection - safety::kRampTicks;
  switch (kind.onset) {
    case Onset::beginning:
      return 0;
    case Onset::anywhere:
      return between(1, latest);
    case Onset::perturbing:
      return between(kPerturbationBegins, kPerturbationEnds - std::min(detection, 1500));
    case Onset::moving:
      return between(1000, kPerturbationEnds - 1000);
    case Onset::ending:
      return between(kTrialEnds - 200, kTrialEnds - 100);
  }
  return 0;
}

/// Whether the recording holds, tick for tick, what reached the robot.
bool holds_every_command(const fs::path& file, const std::vector<FaultyDevice::Received>& received) {
  const auto recording = recording::read(file, {});
  if (!recording || std::cmp_not_equal(recording->samples(), received.size())) return false;
  if (recording->metadata.at("ended") != word_of(journal::Ending::How::safety_stop)) return false;
  const Channel *first = recording->find("torque_1"), *second = recording->find("torque_2");
  for (std::size_t i = 0; i < received.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const Vector2d& torque = received[i].command.torque;
    if (first->values[at] != torque[0] || second->values[at] != torque[1]) return false;
  }
  return true;
}

int ticks_to_off(const std::vector<FaultyDevice::Received>& received, std::int64_t onset) {
  const auto on = std::ranges::find_if(received.rbegin(), received.rend(), [](const FaultyDevice::Received& one) {
    return one.command.enabled && !one.command.torque.isZero(0.0);
  });
  return std::max(0, static_cast<int>((received.rend() - on) - onset));
}

Result<Outcome> perform(const FaultKind& kind, TrialKind trial_kind, std::uint64_t seed, const fs::path& target) {
  numeric::Random random(seed);
  const int detection = kind.detection[static_cast<std::size_t>(trial_kind)];
  auto trials =
      MBK_TRY(protocol::read_experiment(fault_experiment(trial_kind), "faults.toml", laboratory::read_simulation));
  FaultRun run;
  run.kind = trial_kind;
  run.trial = std::move(trials.front());
  run.trial.seed = seed;
  std::int64_t onset = draw_onset(kind, detection, random);
  kind.make(run, random);

  protocol::Trial elsewhere = run.trial;
  elsewhere.home += kAway * Vector2d(random.uniform() - 0.5, 0.5).normalized();
  auto robot = MBK_TRY(laboratory::simulated_robot(elsewhere));
  const bool keeps_time =
      run.keeps_time || run.outside == Outside::stalled_clock || run.outside == Outside::stalled_recorder;
  const bool paced = keeps_time || run.outside != Outside::nothing;
  realtime::VirtualClock clock(1.0 / run.trial.rate.value, paced ? kPace : 0.0);
  if (run.outside == Outside::stalled_clock) {
    run.fault.reading = [&clock, stall = run.stall](device::State&, int k) {
      if (k == 0) clock.stall(stall);
      return true;
    };
  }
  FaultyDevice device(*robot, run.trial.robot.geometry, run.fault, onset, keeps_time, kTrialEnds + 1000);
  session::Session session({true, 0.0, &clock});
  std::atomic<std::int64_t> begun{-1};
  const auto watch = [&](std::span<const journal::Tick> ticks) {
    if (begun >= 0 || std::cmp_less(ticks.back().number, onset)) return;
    if (run.outside == Outside::operator_stop) {
      begun = device.tick();
      session.flags().operator_stop = true;
    } else if (run.outside == Outside::stalled_recorder) {
      begun = device.tick();
      while (!device.stopped()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  const auto plan = session::make_plan(run.trial);
  if (!plan) return tl::unexpected(plan.error().in(std::string(kind.name)));
  const auto performed = session.perform(device, *plan, target, watch);
  if (!performed) return tl::unexpected(performed.error().in(std::string(kind.name)));
  if (begun >= 0) onset = begun;

  Outcome outcome;
  outcome.reason = performed->trip.reason;
  if (outcome.reason != Reason::none) outcome.ticks = ticks_to_off(device.received(), onset);
  for (const FaultyDevice::Received& one : device.received()) {
    outcome.handle_force = std::max(outcome.handle_force, one.handle_force);
  }
  outcome.speed = device.largest_speed();
  outcome.recorded = holds_every_command(target, device.received());
  std::error_code ignored;
  fs::remove(target, ignored);
  return outcome;
}

/// Every planar trial that comes with the program.
Result<std::vector<protocol::Trial>> ready_trials() {
  std::vector<protocol::Trial> all;
  for (const laboratory::ReadyScenario& one : laboratory::ready_scenarios()) {
    auto trials = protocol::read_experiment(one.text, std::string(one.name) + ".toml", laboratory::read_simulation);
    if (!trials) continue;  // a one-axis machine
    std::ranges::move(*trials, std::back_inserter(all));
  }
  if (all.empty()) return bad_data("no ready scenario is a planar experiment", "");
  return all;
}

struct Job {
  const FaultKind* kind;  // null: nothing breaks
  TrialKind trial_kind;
  int run;
};

/// What has to be so after every fault: nearly always by its share, and by the count of these runs always.
void add_demand(const std::string& what, int good, int runs, ValidationTable& table) {
  table.rows.push_back(share_row(what, good, runs, kAlways));
  table.rows.push_back(exact_row(what + ": exceptions", runs - good, Range{0.0, 0.0}, fmt::format("of {}", runs)));
}

/// The slowest of the runs of a kind, in one of the trials; the documented time is accepted.
struct Slowest {
  const FaultKind* kind;
  TrialKind trial_kind;
  int ticks = 0, in_time = 0, runs = 0;
};

void add_kind(const Slowest& slowest, int documented, ValidationTable& table) {
  const std::string what = fmt::format("{}, {} trial: off ", slowest.kind->name, word_of(slowest.trial_kind));
  table.rows.push_back(
      share_row(fmt::format("{}within {} ticks", what, documented), slowest.in_time, slowest.runs, kNearNominal));
  table.rows.push_back(exact_row(what + "after, slowest run", slowest.ticks, Range{0.0, documented}, "ticks"));
}

}  // namespace

Result<ValidationTable> faults_study(const StudyOptions& options) {
  if (options.runs < 1) return no_runs(options.runs);
  const auto folder = MBK_TRY(TemporaryFolder::create("mbk-faults"));
  const auto ready = MBK_TRY(ready_trials());

  std::vector<Job> jobs;
  for (const FaultKind& kind : fault_kinds()) {
    for (const TrialKind trial_kind : kTrialKinds) {
      if (kind.detection[static_cast<std::size_t>(trial_kind)] < 0) continue;
      for (int run = 0; run < options.runs; ++run) jobs.push_back({&kind, trial_kind, run});
    }
  }
  const std::size_t faulty = jobs.size();
  for (int run = 0; run < 10 * options.runs; ++run) jobs.push_back({nullptr, TrialKind::position, run});

  const auto ran = MBK_TRY(each_run(options, static_cast<int>(jobs.size()), [&](int i) -> Result<Outcome> {
    const Job& job = jobs[static_cast<std::size_t>(i)];
    const std::uint64_t seed = 100'000 * options.seed + static_cast<std::uint64_t>(i);
    if (job.kind != nullptr) {
      return perform(*job.kind, job.trial_kind, seed, folder.path() / fmt::format("{}.h5", i));
    }
    protocol::Trial trial = ready[static_cast<std::size_t>(job.run) % ready.size()];
    trial.seed = seed;
    const auto plan = MBK_TRY(session::make_plan(std::move(trial)));
    const auto rehearsal = MBK_TRY(session::rehearse(plan));
    Outcome outcome;
    outcome.reason = rehearsal.trip.reason;
    return outcome;
  }));
  const std::vector<Outcome>& outcomes = ran;

  ValidationTable table{
      "faults", "after any single fault: are the motors off in time, for the right reason, and is everything recorded?",
      "ticks", options.runs, options.seed};
  const double cap = safety::Limits{}.handle_force;
  double handle_force = 0.0, runaway_speed = 0.0;
  int right = 0, off = 0, recorded = 0;
  Slowest slowest{};
  for (std::size_t i = 0; i < faulty; ++i) {
    const auto& [kind, trial_kind, run] = jobs[i];
    const Outcome& outcome = outcomes[i];
    const int documented = kind->detection[static_cast<std::size_t>(trial_kind)] + safety::kRampTicks;
    if (run == 0) slowest = {kind, trial_kind};
    const bool never = outcome.ticks<0, reason_is_right = std::ranges::count(kind->reasons, outcome.reason)> 0;
    slowest.ticks = std::max(slowest.ticks, never ? kTrialEnds : static_cast<int>(outcome.ticks));
    slowest.in_time += !never && outcome.ticks <= documented ? 1 : 0;
    if (++slowest.runs == options.runs) add_kind(slowest, documented, table);
    off += !never && outcome.ticks <= documented ? 1 : 0;
    right += reason_is_right ? 1 : 0;
    recorded += outcome.recorded ? 1 : 0;
    handle_force = std::max(handle_force, outcome.handle_force);
    if (trial_kind == TrialKind::position && kind->name.starts_with(kWrongWay)) {
      runaway_speed = std::max(runaway_speed, outcome.speed);
    }
    if (never || outcome.ticks > documented || !reason_is_right || !outcome.recorded ||
        outcome.handle_force > cap + kForceTolerance) {
      table.notes.push_back(fmt::format("{}, {} trial, run {}: off after {} ticks by {}, {:.3f} N, recording {}",
                                        kind->name, word_of(trial_kind), run, outcome.ticks, word_of(outcome.reason),
                                        outcome.handle_force, outcome.recorded ? "complete" : "incomplete"));
    }
  }
  const auto of = static_cast<int>(faulty);
  add_demand("motors off in time", off, of, table);
  add_demand("reason is a right one", right, of, table);
  add_demand("every command in the recording", recorded, of, table);
  table.rows.push_back(exact_row(fmt::format("hand speed reached, {}, position trials", kWrongWay), runaway_speed,
                                 Range{0.0, kRunawaySpeed}, "m/s"));
  int trips = 0;
  for (std::size_t i = faulty; i < jobs.size(); ++i) {
    if (outcomes[i].reason == Reason::none) continue;
    ++trips;
    table.notes.push_back(fmt::format("without a fault: {} in {}, seed {}", word_of(outcomes[i].reason),
                                      ready[static_cast<std::size_t>(jobs[i].run) % ready.size()].protocol,
                                      100'000 * options.seed + i));
  }
  table.rows.push_back(exact_row("largest force commanded at the handle, by the true angles", handle_force,
                                 Range{0.0, cap + kForceTolerance}, "N"));
  const auto free_trials = static_cast<int>(jobs.size() - faulty);
  table.rows.push_back(share_row("trips in trials without a fault", trips, free_trials, kHardlyEver));
  table.rows.push_back(
      exact_row("trips in trials without a fault: cases", trips, Range{0.0, 0.0}, fmt::format("of {}", free_trials)));
  table.notes.push_back(fmt::format(
      "A tick is 1 ms. Expected times are those of docs/guide/safety.md: time to the trip and {} ticks of ramp.",
      safety::kRampTicks));
  return table;
}

}  // namespace mbk::validation
