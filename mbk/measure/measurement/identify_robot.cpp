#include "mbk/measure/measurement/identify_robot.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "mbk/files/recording/inspect.h"
#include "mbk/measure/preprocess/resample.h"

namespace mbk::measurement {
namespace {

Result<std::vector<PreparedDynamics>> prepare_all(std::span<const Recording> recordings,
                                                  const robot::DynamicModel& model,
                                                  preprocess::DynamicsOptions options) {
  std::vector<PreparedDynamics> trials;
  const auto prepare = [&](const Recording& recording) -> Result<PreparedDynamics> {
    auto trial = preprocess::prepare_dynamics(recording, recording::inspect(recording), model, options);
    if (!trial && !recording.sources.empty()) return tl::unexpected(trial.error().in(recording.sources[0].path));
    return trial;
  };
  for (const Recording& recording : recordings) {
    auto trial = prepare(recording);
    if (!trial) return tl::unexpected(trial.error());
    trials.push_back(std::move(*trial));
  }
  // One band and one spacing of the rows for all: those of the recording that moves fastest.
  const auto cutoff_of = [](const PreparedDynamics& trial) {
    return trial.preparation.cutoff.value_or(Hertz(0.0)).value;
  };
  const auto fastest = std::ranges::max_element(trials, {}, cutoff_of);
  if (fastest == trials.end() || !fastest->preparation.cutoff) return trials;
  const Preparation how = fastest->preparation;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (cutoff_of(trials[k]) == how.cutoff->value && trials[k].preparation.every == how.every) continue;
    options.signals.cutoff = how.cutoff;
    options.signals.every = how.every;
    auto trial = prepare(recordings[k]);
    if (!trial) return tl::unexpected(trial.error());
    trials[k] = std::move(*trial);
    trials[k].preparation.cutoff_rule = how.cutoff_rule;
  }
  return trials;
}

/// Recordings on an even clock.
Result<std::vector<Recording>> even(std::span<const Recording> recordings, Hertz rate) {
  std::vector<Recording> all;
  for (const Recording& recording : recordings) {
    auto resampled = preprocess::resample(recording, rate);
    if (!resampled) return tl::unexpected(resampled.error());
    all.push_back(std::move(*resampled));
  }
  return all;
}

/// Both sets of recordings, prepared alike.
struct Prepared {
  std::vector<PreparedDynamics> trials, held_out;
};

Result<Prepared> prepare_both(std::span<const Recording> recordings, std::span<const Recording> held_out,
                              const robot::DynamicModel& model, const preprocess::DynamicsOptions& options) {
  auto trials = prepare_all(recordings, model, options);
  if (!trials) return tl::unexpected(trials.error());
  preprocess::DynamicsOptions judged = options;
  if (const Preparation& how = trials->front().preparation; how.cutoff) {
    judged.signals.cutoff = how.cutoff;
    judged.signals.every = how.every;
  }
  judged.signals.window = {};
  if (trials->front().motion_cutoff > 0.0) judged.motion_cutoff = Hertz(trials->front().motion_cutoff);
  auto others = prepare_all(held_out, model, judged);
  if (!others) return tl::unexpected(others.error());
  return Prepared{std::move(*trials), std::move(*others)};
}

/// The pipeline with everything given.
Result<identify::RobotFit> fit_once(std::span<const Recording> recordings, std::span<const Recording> held_out,
                                    const robot::DynamicModel& model, const RobotOptions& options) {
  const auto both = prepare_both(recordings, held_out, model, options.preprocess);
  if (!both) return tl::unexpected(both.error());
  return identify::fit_robot(both->trials, both->held_out, model, options.fit);
}

/// With the delay found where it is wanted.
Result<RobotIdentification> fit_delay(std::span<const Recording> recordings, std::span<const Recording> held_out,
                                      robot::DynamicModel model, const RobotOptions& options) {
  constexpr int kMaxPasses = 8;
  constexpr double kSettled = 1e-5;  // [s], a hundredth of a sample at 1 kHz
  for (int pass = 1;; ++pass) {
    auto made = fit_once(recordings, held_out, model, options);
    if (!made) return tl::unexpected(made.error());
    if (!options.fit.delay || std::abs(made->delay_correction) < kSettled || pass == kMaxPasses) {
      return std::move(made->identification);
    }
    model.delay = std::clamp(model.delay + made->delay_correction, -0.2, 0.2);
  }
}

double unexplained(const RobotIdentification& found) {
  double sum = 0.0;
  for (const TorqueFit& fit : found.fit) sum += std::log(std::max(fit.rmse_in_sample, 1e-300));
  return sum;
}

}  // namespace

Result<RobotIdentification> identify_robot(std::span<const Recording> recordings, std::span<const Recording> held_out,
                                           const robot::DynamicModel& model, const RobotOptions& options) {
  RobotOptions all = options;
  all.preprocess.instruments = options.fit.method == RobotMethod::instrumental_variables;
  if (options.resample) {
    all.resample.reset();
    const auto trials = even(recordings, *options.resample);
    if (!trials) return tl::unexpected(trials.error());
    const auto others = even(held_out, *options.resample);
    if (!others) return tl::unexpected(others.error());
    return identify_robot(*trials, *others, model, all);
  }
  if (!options.stribeck_velocity || !model.drive.stribeck) return fit_delay(recordings, held_out, model, all);

  // Between the velocity at which the sign is smooth and a hundred times that.
  const double low = std::log(std::max(1.5 * model.drive.smoothing, 1e-4)), high = low + std::log(100.0);
  robot::DynamicModel tried = model;
  Result<RobotIdentification> best = bad_data("not tried");
  double least = std::numeric_limits<double>::infinity();
  std::optional<Error> failure;
  const auto left = [&](double log_velocity) {
    tried.drive.stribeck_velocity = std::exp(log_velocity);
    auto found = fit_delay(recordings, held_out, tried, all);
    if (!found) {
      failure = found.error();
      return std::numeric_limits<double>::max();
    }
    const double value = unexplained(*found);
    if (value < least) {
      least = value;
      best = std::move(found);
    }
    return value;
  };
  // There may be several minima: the best of a coarse grid, then down to the bottom of that one.
  constexpr int kGrid = 8;
  const double step = (high - low) / kGrid;
  double nearest = low;
  for (int k = 0; k <= kGrid; ++k) {
    const double before = least;
    if (left(low + k * step); least < before) nearest = low + k * step;
  }
  constexpr int kBits = 8;  // of the logarithm's range: 2 % of the velocity
  boost::math::tools::brent_find_minima(left, std::max(low, nearest - step), std::min(high, nearest + step), kBits);
  if (failure) return tl::unexpected(*failure);
  return best;
}

}  // namespace mbk::measurement
