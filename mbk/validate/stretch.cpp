#include "mbk/measure/explore/stretch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "mbk/measure/explore/stretch_muscles.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_stretches.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace stretch_runs {

/// What one seed shows. Speeds without a catch have no share in the shares of catches.
struct StretchRun {
  bool healthy_slope_held = false, healthy_called = false, healthy_catch = false;
  bool uneven_called = false;  ///< a viscosity that is twice as large at the end
  bool slope_held = false, called = false;
  std::vector<bool> catch_found, catch_held;  ///< by speed but for the slowest; by catch
  std::vector<double> catch_error;            ///< [deg]
  std::vector<double> catch_after_onset;      ///< after the angle at which the reflex torque begins [deg]
  bool threshold_found = false;
  double threshold_error = 0;  ///< [deg]
  bool relaxed_responds = false, emg_threshold_found = false, emg_threshold_held = false;
  double emg_threshold_error = 0;  ///< [deg]
};

Result<StretchDirection> forward(const ExplorationTrial& trial) {
  std::vector<Warning> warnings;
  auto found = MBK_TRY(explore::stretch({&trial, 1}, {}, warnings));
  return found.directions.front();
}

bool holds(const StretchValue& value, double truth) {
  return value.interval95 && value.interval95->first <= truth && truth <= value.interval95->second;
}

bool called_dependent(const StretchDirection& found) {
  return found.verdict == VelocityDependence::velocity_dependent;
}

/// The same limb, with EMG at 1000 Hz and 0.6 s of rest.
Result<void> add_emg_run(const StretchedLimb& limb, const StretchNoise& noise, std::uint64_t seed, StretchRun& run) {
  const StretchesWithEmg all = stretched_with_emg(limb, {.rate = 1000.0, .rest = 0.6}, noise, seed);
  std::vector<Warning> warnings;
  auto found = MBK_TRY(explore::stretch({&all.trial, 1}, {}, warnings));
  const Recording* const recording = &all.recording;
  MBK_TRY(explore::add_stretch_muscles({&recording, 1}, {&all.trial, 1}, found));
  run.relaxed_responds =
      std::ranges::any_of(found.directions, [](const StretchDirection& one) { return one.muscles.back().responds(); });
  const StretchMuscle& biceps = found.directions.front().muscles.front();
  run.emg_threshold_found = biceps.threshold.has_value();
  if (!biceps.threshold) return {};
  run.emg_threshold_held = holds(*biceps.threshold, limb.threshold);
  run.emg_threshold_error = (biceps.threshold->value - limb.threshold) * kDegrees;
  return {};
}

Result<StretchRun> stretch_run(std::uint64_t seed) {
  StretchRun run;
  const StretchProtocol protocol;
  const StretchNoise noise;
  const StretchedLimb healthy = healthy_limb(seed);
  const auto relaxed = MBK_TRY(forward(stretched(healthy, protocol, noise, seed)));
  run.healthy_slope_held = holds(relaxed.slope, healthy.viscosity);
  run.healthy_called = called_dependent(relaxed);
  for (const StretchSpeed& one : relaxed.speeds) run.healthy_catch |= one.catch_finding == CatchFinding::found;

  StretchedLimb uneven = healthy;
  uneven.viscosity_rise = 1.0;
  const auto by_uneven = MBK_TRY(forward(stretched(uneven, protocol, noise, seed)));
  run.uneven_called = called_dependent(by_uneven);

  const StretchedLimb spastic = spastic_limb(seed);
  const auto found = MBK_TRY(forward(stretched(spastic, protocol, noise, seed)));
  const auto truth = MBK_TRY(forward(stretched_on_average(spastic, protocol, noise)));
  run.slope_held = holds(found.slope, truth.slope.value);
  run.called = called_dependent(found);
  for (std::size_t k = 1; k < found.speeds.size(); ++k) {
    const StretchSpeed &one = found.speeds[k], &expected = truth.speeds[k];
    run.catch_found.push_back(one.catch_angle.has_value());
    if (!one.catch_angle || !expected.catch_angle) continue;
    run.catch_held.push_back(holds(*one.catch_angle, expected.catch_angle->value));
    run.catch_error.push_back((one.catch_angle->value - expected.catch_angle->value) * kDegrees);
    const double onset = spastic.threshold + (spastic.delay - spastic.threshold_shift) * one.speed;
    run.catch_after_onset.push_back((one.catch_angle->value - onset) * kDegrees);
  }
  if (found.reflex_threshold) {
    run.threshold_found = true;
    run.threshold_error = (found.reflex_threshold->value - spastic.threshold) * kDegrees;
  }
  MBK_TRY(add_emg_run(spastic, noise, seed, run));
  return run;
}

Vector as_vector(const std::vector<double>& values) {
  return Vector::Map(values.data(), static_cast<Index>(values.size()));
}

}  // namespace stretch_runs

Result<ValidationTable> stretch_study(const StudyOptions& options) {
  using namespace stretch_runs;
  const auto ran = MBK_TRY(seeded_runs(options, stretch_run));
  ValidationTable table{"stretch",
                        "stretches of a healthy and a spastic elbow at five speeds, five times each: slope over speed, "
                        "angle of catch, verdict",
                        "%", options.runs, options.seed};
  const auto share = [&](const char* what, bool StretchRun::*is, std::optional<Range> expected) {
    table.rows.push_back(share_row(
        what, ran, [is](const StretchRun& run) { return run.*is; }, expected));
  };
  share("healthy: 95 % interval of the slope holds the viscosity", &StretchRun::healthy_slope_held, kNominal);
  share("healthy: called velocity-dependent", &StretchRun::healthy_called, kHardlyEver);
  share("healthy: a catch at any speed", &StretchRun::healthy_catch, kHardlyEver);
  share("healthy, viscosity doubles over the stretch: called velocity-dependent", &StretchRun::uneven_called,
        kHardlyEver);
  share("spastic: 95 % interval holds the slope", &StretchRun::slope_held, kNominal);
  share("spastic: called velocity-dependent", &StretchRun::called, std::nullopt);
  std::vector<bool> found, held;
  std::vector<double> error, after, threshold;
  for (const StretchRun& run : ran) {
    found.insert(found.end(), run.catch_found.begin(), run.catch_found.end());
    held.insert(held.end(), run.catch_held.begin(), run.catch_held.end());
    error.insert(error.end(), run.catch_error.begin(), run.catch_error.end());
    after.insert(after.end(), run.catch_after_onset.begin(), run.catch_after_onset.end());
    if (run.threshold_found) threshold.push_back(run.threshold_error);
  }
  const auto is = [](bool one) { return one; };
  table.rows.push_back(share_row("spastic: catch found, of all speeds above the slowest", found, is, std::nullopt));
  table.rows.push_back(share_row("spastic: 95 % interval holds the angle of catch", held, is, kNominal));
  if (error.size() > 1) {
    table.rows.push_back(
        mean_row("angle of catch less that of repetitions without number", as_vector(error), Range{-1.0, 1.0}, "deg"));
    table.rows.push_back(
        mean_row("angle of catch less that at which reflex torque begins", as_vector(after), std::nullopt, "deg"));
  }
  if (threshold.size() > 1) {
    table.rows.push_back(
        mean_row("threshold at rest less that of the reflex", as_vector(threshold), std::nullopt, "deg"));
  }
  share("relaxed muscle: an onset of EMG in any stretch, either direction", &StretchRun::relaxed_responds,
        Range{0.0, 5.0});
  share("spastic: threshold at rest from EMG identified", &StretchRun::emg_threshold_found, std::nullopt);
  std::vector<bool> emg_held;
  std::vector<double> emg_error;
  for (const StretchRun& run : ran) {
    if (!run.emg_threshold_found) continue;
    emg_held.push_back(run.emg_threshold_held);
    emg_error.push_back(run.emg_threshold_error);
  }
  table.rows.push_back(
      share_row("spastic: 95 % interval holds the threshold at rest from EMG", emg_held, is, kNominal));
  if (emg_error.size() > 1) {
    table.rows.push_back(
        mean_row("threshold at rest from EMG less that of the reflex", as_vector(emg_error), Range{-3.0, 3.0}, "deg"));
  }
  table.notes = {
      "The angle of catch is that of the best-fitting curve that is flat, rises and is flat again, applied to "
      "stretches without noise; muscle and slowest stretch move it from the angle at which the reflex torque begins."};
  return table;
}

}  // namespace mbk::validation
