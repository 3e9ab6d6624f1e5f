#include "mbk/measure/identify/stated_inertia.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/stacked_dynamics.h"

namespace mbk::identify {
namespace {

/// Whether the description states a mass for every body.
bool states_all_bodies(const robot::DynamicModel& stated) {
  const std::vector<robot::Coefficient>& bodies = stated.mechanism->coefficients();
  const Vector& values = stated.mechanism->stated_coefficients();
  if (values.size() != std::ssize(bodies) || stated.parameters.size() < values.size()) return false;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (bodies[k].name.ends_with(".mass") && !(values[static_cast<Index>(k)] > 0.0)) return false;
  }
  return true;
}

/// Sum of squares of what a joint's torque leaves beyond columns Z.
double left_beyond(const Matrix& Z, const Vector& torque) {
  if (Z.cols() == 0) return torque.squaredNorm();
  const auto fit = numeric::fit_least_squares(Z, torque);
  return fit ? (torque - Z * fit->free).squaredNorm() : torque.squaredNorm();
}

/// @param lags  of Newey and West
StatedRatio ratio_of(const StackedDynamics& all, const robot::DynamicModel& stated, const RobotIdentification& found,
                     Index lags, Index joint) {
  constexpr double kSmallestShare = 0.1;  // of the torque, that the bodies take
  const Matrix& W = all.W[static_cast<std::size_t>(joint)];
  const std::vector<robot::Coefficient> names = stated.coefficients();
  const auto bodies = std::ssize(stated.mechanism->coefficients());
  Vector known_values = stated.parameters;
  known_values.head(bodies) = stated.mechanism->stated_coefficients();
  std::vector<Index> of_stated, of_drive;
  for (Index k = 0; k < std::ssize(names); ++k) {
    const bool rotor = names[static_cast<std::size_t>(k)].name.starts_with("motor_inertia");
    const bool known = k < bodies || (rotor && stated.parameters[k] > 0.0);
    if (known) of_stated.push_back(k);
    if (!known && !W.col(k).isZero(0.0)) of_drive.push_back(k);
  }
  const Index rows = all.rows();
  Matrix Z(rows, 1 + std::ssize(of_drive));
  Z << W(Eigen::all, of_stated) * known_values(of_stated), W(Eigen::all, of_drive);
  const Vector torque = all.torque.col(joint), residual = torque - W * found.model.parameters;
  StatedRatio made;
  const Matrix drive = Z.rightCols(std::ssize(of_drive));
  const double of_bodies = left_beyond(drive, Z.col(0));
  if (rows < 4 * Z.cols() || !(of_bodies > kSmallestShare * kSmallestShare * torque.squaredNorm())) return made;
  const auto fit = numeric::fit_least_squares(Z, torque);
  if (!fit || fit->rank < Z.cols()) return made;
  const Vector left = torque - Z * fit->free;
  const double widening =
      numeric::newey_west_widening(std::min(1.0, static_cast<double>(lags) / static_cast<double>(rows)));
  made.ratio = fit->free[0];
  made.standard_error =
      widening * std::sqrt(std::max(0.0, numeric::newey_west_covariance(*fit, Z, left, all.ranges, lags)(0, 0)));
  const double of_found = residual.squaredNorm(), count = static_cast<double>(rows);
  made.missed = std::sqrt(std::max(0.0, left_beyond(drive, torque - Z.col(0)) - of_found) / count);
  made.missed_scaled = std::sqrt(std::max(0.0, left.squaredNorm() - of_found) / count);
  return made;
}

bool is_another_factor(const StatedRatio& one) {
  constexpr double kMatters = 0.05, kBeyondChance = 4.5, kRest = 0.5;
  return std::abs(one.ratio - 1.0) > std::max(kMatters, kBeyondChance * one.standard_error) &&
         one.missed_scaled < kRest * one.missed;
}

}  // namespace

void compare_with_stated(const std::vector<PreparedDynamics>& trials, const robot::DynamicModel& stated,
                         RobotIdentification& found) {
  found.stated.clear();
  if (!states_all_bodies(stated)) return;
  const StackedDynamics all = stack_rows(trials, std::nullopt);
  const auto lags = static_cast<Index>(std::llround(found.hac_lag_s / trials.front().sample_time));
  double low = 1e300, high = -1e300;
  std::vector<std::string> factors;
  for (Index joint = 0; joint < trials.front().torque.cols(); ++joint) {
    found.stated.push_back(ratio_of(all, stated, found, lags, joint));
    const StatedRatio& one = found.stated.back();
    if (!is_another_factor(one)) continue;
    factors.push_back(
        fmt::format("{:.3g} ± {:.2g} at joint {}", one.ratio, numeric::kNormal95 * one.standard_error, joint + 1));
    low = std::min(low, one.ratio);
    high = std::max(high, one.ratio);
  }
  if (factors.empty()) return;
  constexpr double kAlike = 0.03;
  const bool alike =
      std::ssize(factors) == std::ssize(found.stated) && factors.size() > 1 && high - low < kAlike * high;
  std::string which = alike ? fmt::format("{:.3g} at every joint", 0.5 * (low + high)) : "";
  if (!alike) {
    for (const std::string& one : factors) which += (which.empty() ? "" : ", ") + one;
  }
  found.warnings.push_back(
      {WarningCode::torque_unit,
       fmt::format("the torque differs from that for inertia and weight of the URDF by a constant factor: {}", which),
       "check the torque constant and the gear ratio; if the torque is wrong, divide it by the factor with --channels; "
       "if the URDF is wrong, correct its masses"});
}

}  // namespace mbk::identify
