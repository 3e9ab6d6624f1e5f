#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mbk/measure/measurement/explore.h"
#include "mbk/simulate/laboratory/scenario.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace change_detail {

using laboratory::PlanarTrial;
using laboratory::Scenario;

constexpr double kEdge = 2.0;     ///< around a step and at the ends of the range a smooth curve is not judged [s]
constexpr double kWithin = 0.15;  ///< of the stiffness

/// A limb whose stiffness is multiplied by straight lines between instants; constant where there are none.
struct ChangeCondition {
  std::string name, scenario;
  std::vector<participant::StiffnessAt> schedule;
  std::vector<double> steps;  ///< instants that are not judged [s]
  std::function<void(Scenario&)> more = [](Scenario&) {};
};

std::vector<ChangeCondition> conditions() {
  std::vector<participant::StiffnessAt> wave;
  constexpr double kStepOfWave = 0.25, kLast = 70.0, kWaveHz = 0.1;
  for (double t = 0.0; t < kLast; t += kStepOfWave) {
    wave.push_back({t, 1.0 + 0.5 * std::sin(2.0 * std::numbers::pi * kWaveHz * t)});
  }
  const auto drifts = [](Scenario& scenario) {
    std::get<laboratory::LoadCellOptions<2>>(std::get<PlanarTrial>(scenario.trial).sensors.force)
        .drift_rate.setConstant(0.02);
  };
  return {{"constant, multisine", "relaxed_sinusoidal", {}, {}},
          {"constant, pulses", "relaxed_underdamped", {}, {}},
          {"constant, force zero drifting by 0.02 N/s", "relaxed_sinusoidal", {}, {}, drifts},
          {"stiffness × 3 from half time", "relaxed_sinusoidal", {{31.0, 1.0}, {32.0, 3.0}}, {31.0, 32.0}},
          {"stiffness from 1 to 2 times", "relaxed_sinusoidal", {{0.0, 1.0}, {62.0, 2.0}}, {}},
          {"stiffness ± 50 % at 0.1 Hz", "relaxed_sinusoidal", wave, {}}};
}

double factor_at(const std::vector<participant::StiffnessAt>& schedule, double t) {
  if (schedule.empty()) return 1.0;
  const auto after = std::ranges::upper_bound(schedule, t, {}, &participant::StiffnessAt::time);
  if (after == schedule.begin()) return after->factor;
  const auto& before = *std::prev(after);
  if (after == schedule.end()) return before.factor;
  return before.factor + (t - before.time) / (after->time - before.time) * (after->factor - before.factor);
}

struct ChangeRun {
  bool changes = false;
  double off = 0;   ///< largest |K̂ − K|/|K| along the course, steps and ends left out
  double held = 0;  ///< share of entries of K that the pointwise intervals hold
};

Result<ChangeRun> run_of(const ChangeCondition& condition, std::uint64_t seed) {
  auto scenarios = MBK_TRY(ready(condition.scenario));
  Scenario scenario = std::move(scenarios.front());
  scenario.seed = seed;
  std::get<participant::ArmOptions>(std::get<PlanarTrial>(scenario.trial).load).stiffness_schedule = condition.schedule;
  condition.more(scenario);
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  const auto found = MBK_TRY(measurement::time_course({&performance.recording, 1}, {}));
  // The truth of the recording is its mean over the trial.
  const Vector& time = performance.recording.time;
  double mean = 0.0;
  for (const double t : time) mean += factor_at(condition.schedule, t) / static_cast<double>(time.size());
  ChangeRun run;
  run.changes = found.changes;
  Index points = 0;
  for (Index k = 0; k < found.at.size(); ++k) {
    const double t = found.at[k];
    const auto near = [t](double instant) { return std::abs(t - instant) < kEdge; };
    const bool at_end = found.at.size() > 1 && (near(found.from) || near(found.to));
    if (at_end || std::ranges::any_of(condition.steps, near)) continue;
    const Matrix truth = performance.truth.K * (factor_at(condition.schedule, t) / mean);
    const Matrix away = found.K.value.row(k).reshaped(2, 2) - truth;
    run.off = std::max(run.off, away.norm() / truth.norm());
    const Matrix half = found.K.half_width.row(k).reshaped(2, 2);
    run.held += 0.25 * static_cast<double>((away.array().abs() <= half.array()).count());
    ++points;
  }
  run.held /= static_cast<double>(points);
  return run;
}

Result<ValidationTable> study(const StudyOptions& options) {
  const std::vector<ChangeCondition> all = conditions();
  const auto runs = MBK_TRY(seeded_runs(options, [&](std::uint64_t seed) -> Result<std::vector<ChangeRun>> {
    std::vector<ChangeRun> of_all;
    for (const ChangeCondition& condition : all) {
      const auto run = run_of(condition, seed);
      if (!run) return tl::unexpected(run.error().in(condition.name));
      of_all.push_back(*run);
    }
    return of_all;
  }));
  ValidationTable table{"change",
                        "is a changing stiffness detected with its time course, and a constant one called constant?",
                        "% of the trials", options.runs, options.seed};
  for (std::size_t c = 0; c < all.size(); ++c) {
    std::vector<ChangeRun> own;
    Vector off(static_cast<Index>(runs.size()));
    double held = 0.0;
    for (const auto& run : runs) {
      off[static_cast<Index>(own.size())] = 100.0 * run[c].off;
      held += run[c].held;
      own.push_back(run[c]);
    }
    const bool constant = all[c].schedule.empty();
    table.rows.push_back(share_row(
        all[c].name + ": called changing", own, [](const ChangeRun& run) { return run.changes; },
        constant ? kHardlyEver : kNearlyAlways));
    if (!constant) {
      table.rows.push_back(share_row(all[c].name + ": course of K within 15 %", own,
                                     [](const ChangeRun& run) { return run.changes && run.off <= kWithin; }, {}));
    }
    // A smooth curve through a fast wave is only reported.
    const bool judged = !all[c].steps.empty();
    table.rows.push_back(mean_row(all[c].name + ": K off at most", off,
                                  judged ? std::optional(Range{0.0, 100.0 * kWithin}) : std::nullopt, "%"));
    table.rows.push_back(share_row(all[c].name + ": K inside the pointwise intervals",
                                   static_cast<int>(std::lround(held)), static_cast<int>(own.size()), {}));
  }
  table.notes = {
      "Relaxed arm of participant P1 (Dyck 2013), 62 s of a multisine or 16 pulses. The course is judged by Frobenius "
      "norms at 41 instants, without 2 s around a step and at both ends: no curve through noise follows a step.",
      "'Inside' is the share of the four entries of K at those instants over all trials."};
  return table;
}

}  // namespace change_detail

Result<ValidationTable> change_study(const StudyOptions& options) {
  return change_detail::study(options);
}

}  // namespace mbk::validation
