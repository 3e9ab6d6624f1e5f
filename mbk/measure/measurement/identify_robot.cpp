#include "mbk/measure/measurement/identify_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/identify/coupled_drives.h"
#include "mbk/measure/identify/stated_inertia.h"
#include "mbk/measure/identify/transmission_checks.h"
#include "mbk/measure/preprocess/resample.h"

namespace mbk::measurement {
namespace {

Result<std::vector<PreparedDynamics>> prepare_all(std::span<const Recording> recordings,
                                                  const robot::DynamicModel& model,
                                                  preprocess::DynamicsOptions options) {
  std::vector<PreparedDynamics> trials;
  const auto prepare = [&](const Recording& recording) -> Result<PreparedDynamics> {
    auto trial = preprocess::prepare_dynamics(recording, recording::inspect(recording), model, options);
    if (!trial && !recording.sources.empty()) return tl::unexpected(trial.error().in(recording.sources[0].label()));
    return trial;
  };
  for (const Recording& recording : recordings) {
    auto trial = MBK_TRY(prepare(recording));
    trials.push_back(std::move(trial));
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
    trials[k] = MBK_TRY(prepare(recordings[k]));
    trials[k].preparation.cutoff_rule = how.cutoff_rule;
  }
  return trials;
}

/// Recordings on an even clock.
Result<std::vector<Recording>> even(std::span<const Recording> recordings, Hertz rate) {
  std::vector<Recording> all;
  for (const Recording& recording : recordings) {
    auto resampled = MBK_TRY(preprocess::resample(recording, rate));
    all.push_back(std::move(resampled));
  }
  return all;
}

/// Both sets of recordings, prepared alike.
struct Prepared {
  std::vector<PreparedDynamics> trials, held_out;
};

Result<Prepared> prepare_both(std::span<const Recording> recordings, std::span<const Recording> held_out,
                              const robot::DynamicModel& model, const preprocess::DynamicsOptions& options) {
  auto trials = MBK_TRY(prepare_all(recordings, model, options));
  preprocess::DynamicsOptions judged = options;
  if (const Preparation& how = trials.front().preparation; how.cutoff) {
    judged.signals.cutoff = how.cutoff;
    judged.signals.every = how.every;
  }
  judged.signals.window = {};
  if (trials.front().motion_cutoff > 0.0) judged.motion_cutoff = Hertz(trials.front().motion_cutoff);
  auto others = MBK_TRY(prepare_all(held_out, model, judged));
  return Prepared{std::move(trials), std::move(others)};
}

/// The pipeline with everything given.
Result<identify::RobotFit> fit_once(std::span<const Recording> recordings, std::span<const Recording> held_out,
                                    const robot::DynamicModel& model, const RobotOptions& options) {
  const auto both = MBK_TRY(prepare_both(recordings, held_out, model, options.preprocess));
  return identify::fit_robot(both.trials, both.held_out, model, options.fit);
}

/// With the delay found where it is wanted.
Result<RobotIdentification> fit_delay(std::span<const Recording> recordings, std::span<const Recording> held_out,
                                      robot::DynamicModel model, const RobotOptions& options) {
  constexpr int kMaxPasses = 8;
  constexpr double kSettled = 1e-5;  // [s], a hundredth of a sample at 1 kHz
  for (int pass = 1;; ++pass) {
    auto made = MBK_TRY(fit_once(recordings, held_out, model, options));
    if (!options.fit.delay || std::abs(made.delay_correction) < kSettled || pass == kMaxPasses) {
      return std::move(made.identification);
    }
    model.delay = std::clamp(model.delay + made.delay_correction, -0.2, 0.2);
  }
}

const RobotCoefficient* named(const RobotIdentification& found, const std::string& name) {
  const auto one = std::ranges::find(found.coefficients, name, [](const auto& c) { return c.coefficient.name; });
  return one != found.coefficients.end() && one->identified ? &*one : nullptr;
}

/// √2 times the root mean square of each joint's velocity, from its column of viscous friction [rad/s or m/s].
Vector speeds(const std::vector<PreparedDynamics>& trials, const std::vector<robot::Coefficient>& coefficients) {
  const Index joints = trials.front().torque.cols();
  Vector squares = Vector::Zero(joints);
  Index rows = 0;
  for (const PreparedDynamics& trial : trials) rows += trial.torque.rows();
  for (Index joint = 0; joint < joints; ++joint) {
    const auto name = fmt::format("viscous_{}", joint + 1);
    const auto at = std::ranges::find(coefficients, name, &robot::Coefficient::name) - coefficients.begin();
    for (const PreparedDynamics& trial : trials) {
      squares[joint] += trial.regressors[static_cast<std::size_t>(joint)].col(at).squaredNorm();
    }
  }
  return (2.0 * squares / static_cast<double>(std::max<Index>(rows, 1))).cwiseSqrt();
}

double middle(Vector values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Share of the squares of a joint's residual that its drive explains, where the user is told so.
double explained_by_drive(const RobotIdentification& found, std::size_t joint) {
  if (joint >= found.transmission.size()) return 0.0;
  const TransmissionTest& test = found.transmission[joint];
  return std::max(test.elastic.found ? test.elastic.explained : 0.0,
                  test.backlash.found ? test.backlash.explained : 0.0);
}

/// Fits once more with a Stribeck term of a few velocities, at the delay that was found, and says so where friction
/// grows again near standstill: where f_Δ is above 0 beyond chance, a fifth of the Coulomb friction beside it, and
/// matters: the residual falls by a fifth, or Coulomb or viscous friction changes by more than its interval.
void check_friction(std::span<const Recording> recordings, std::span<const Recording> held_out,
                    const std::vector<PreparedDynamics>& trials, const RobotOptions& options,
                    RobotIdentification& found) {
  constexpr double kBeyondChance = 4.5;  // standard errors
  constexpr double kShare = 0.2;         // of the Coulomb friction
  constexpr double kRest = 0.8;          // of the residual
  constexpr double kSlow = 0.5;          // of the speed of the joint: below is near standstill
  const std::vector<TorqueFit>& found_free = found.consistent ? found.consistent->free_fit : found.fit;
  constexpr std::array kVelocities = {0.25, 0.0625, 0.015625};  // of the speed of the joint
  RobotOptions once = options;
  once.fit.delay = once.fit.consistent = false;
  robot::DynamicModel model = found.model;
  model.drive.stribeck = true;
  const auto joints = static_cast<std::size_t>(model.mechanism->joints());
  struct Growth {
    double errors = 0, share = 0, velocity = 0, explained = 0;
  };
  std::vector<Growth> most(joints);
  // What is fixed keeps its value among more coefficients.
  const std::vector<robot::Coefficient> before = found.model.coefficients(), after = model.coefficients();
  model.parameters = Vector::Zero(static_cast<Index>(after.size()));
  once.fit.fixed.clear();
  for (std::size_t k = 0; k < after.size(); ++k) {
    const auto old = std::ranges::find(before, after[k].name, &robot::Coefficient::name);
    if (old == before.end()) continue;
    const Index at = old - before.begin();
    model.parameters[static_cast<Index>(k)] = found.model.parameters[at];
    const bool fixed = std::ranges::find(options.fit.fixed, at) != options.fit.fixed.end();
    if (fixed) once.fit.fixed.push_back(static_cast<Index>(k));
  }
  const Vector speed = speeds(trials, before);
  for (const double factor : kVelocities) {
    model.drive.stribeck_velocity = std::max(factor * middle(speed), 1.5 * model.drive.smoothing);
    if (!(model.drive.stribeck_velocity > 0.0)) continue;
    const auto more = fit_once(recordings, held_out, model, once);
    if (!more) continue;  // too few rows for another term
    for (std::size_t joint = 0; joint < joints; ++joint) {
      if (!(model.drive.stribeck_velocity < kSlow * speed[static_cast<Index>(joint)])) continue;
      const auto of = [&](const char* name, const RobotIdentification& where) {
        return named(where, fmt::format("{}_{}", name, joint + 1));
      };
      const RobotIdentification& with = more->identification;
      const RobotCoefficient *growth = of("stribeck", with), *dry = of("coulomb", with),
                             *dry_before = of("coulomb", found);
      if (growth == nullptr || dry == nullptr || dry_before == nullptr) continue;
      const auto moved = [&](const char* name) {
        const RobotCoefficient *a = of(name, found), *b = of(name, with);
        return a != nullptr && b != nullptr && std::abs(a->value - b->value) > numeric::kNormal95 * a->standard_error;
      };
      const double errors = growth->value / growth->standard_error;
      const double share = growth->value / std::max(std::abs(dry->value), 1e-300);
      const double rest = with.fit[joint].rmse_in_sample / std::max(found_free[joint].rmse_in_sample, 1e-300);
      const bool explains = rest < kRest;
      const double explained = 1.0 - rest * rest;
      if (errors > kBeyondChance) most[joint].explained = std::max(most[joint].explained, explained);
      if (explained < explained_by_drive(found, joint)) continue;  // what it looks like is something else
      if (!(errors > kBeyondChance && share > kShare)) continue;
      if (!explains && !moved("coulomb") && !moved("viscous")) continue;
      if (errors > most[joint].errors)
        most[joint] = {errors, share, model.drive.stribeck_velocity, most[joint].explained};
    }
  }
  for (std::size_t joint = 0; joint < joints; ++joint) {
    TransmissionColumn& gap = found.transmission[joint].backlash;
    if (most[joint].explained > gap.explained) gap.found = false;  // its pulses are those of friction
    if (!(most[joint].errors > 0.0)) continue;
    found.warnings.push_back(
        {WarningCode::dry_friction,
         fmt::format("the friction of joint {} increases near standstill (Stribeck effect), by {:.0f} % of its Coulomb "
                     "friction below about {:.2g} {}, but the model has no term for it",
                     joint + 1, 100.0 * most[joint].share, most[joint].velocity,
                     model.mechanism->slides(static_cast<int>(joint)) ? "m/s" : "rad/s"),
         "add --terms viscous,coulomb,stribeck,offset --stribeck-velocity auto"});
  }
}

/// What the data say of the inertia that is stated, of friction and of the drives, at the delay that was found.
void check_drives(std::span<const Recording> recordings, std::span<const Recording> held_out,
                  const robot::DynamicModel& stated, const RobotOptions& options, RobotIdentification& found) {
  const auto both = prepare_both(recordings, held_out, found.model, options.preprocess);
  if (!both) return;
  identify::compare_with_stated(both->trials, stated, found);
  identify::warn_of_coupled_drives(both->trials, found);
  identify::test_transmission(both->trials, found);
  const robot::DriveTerms& drive = found.model.drive;
  if (drive.coulomb && drive.viscous && !drive.stribeck) {
    check_friction(recordings, held_out, both->trials, options, found);
  }
  identify::warn_of_transmission(found);
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
    const auto trials = MBK_TRY(even(recordings, *options.resample));
    const auto others = MBK_TRY(even(held_out, *options.resample));
    return identify_robot(trials, others, model, all);
  }
  if (!options.stribeck_velocity || !model.drive.stribeck) {
    auto found = fit_delay(recordings, held_out, model, all);
    if (found) check_drives(recordings, held_out, model, all, *found);
    return found;
  }

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
  if (best) check_drives(recordings, held_out, model, all, *best);
  return best;
}

}  // namespace mbk::measurement
