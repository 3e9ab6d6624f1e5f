#include "mbk/measure/identify/coupled_drives.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/measure/identify/stacked_dynamics.h"

namespace mbk::identify {
namespace {

/// The rows of one joint.
struct JointRows {
  Vector residual;
  Matrix own;                    ///< its columns of W that are not 0, and the rate of its torque
  std::vector<Matrix> friction;  ///< of each joint
};

JointRows rows_of_joint(const StackedDynamics& all, const RobotIdentification& found, Index joint) {
  const Matrix& W = all.W[static_cast<std::size_t>(joint)];
  const std::vector<robot::Coefficient> names = found.model.coefficients();
  std::vector<std::vector<Index>> of_friction(all.W.size());
  std::vector<Index> own;
  for (Index k = 0; k < W.cols(); ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)].name;
    for (std::size_t of = 0; of < of_friction.size(); ++of) {
      const bool here = name == fmt::format("viscous_{}", of + 1) || name == fmt::format("coulomb_{}", of + 1);
      if (here) of_friction[of].push_back(k);
    }
    if (!W.col(k).isZero(0.0)) own.push_back(k);
  }
  JointRows made;
  made.residual = all.torque.col(joint) - W * found.model.parameters;
  made.own.resize(all.rows(), std::ssize(own) + 1);
  made.own << W(Eigen::all, own), all.torque_rate.col(joint);
  for (std::size_t of = 0; of < of_friction.size(); ++of) {
    made.friction.emplace_back(all.W[of](Eigen::all, of_friction[of]));
  }
  return made;
}

/// What the speed of joint k may add to the torque of joint j: friction of k, and dry friction of the sum and of the
/// difference of both speeds. Viscous friction is the first column of each.
Matrix coupled_friction(const Matrix& of_j, const Matrix& of_k) {
  constexpr double kSlow = 0.05;  // of the speed: where dry friction reverses
  if (of_j.cols() == 0 || of_k.cols() == 0) return of_k;
  Matrix all(of_k.rows(), of_k.cols() + 2);
  all.leftCols(of_k.cols()) = of_k;
  const double rows = static_cast<double>(std::max<Index>(of_k.rows(), 1));
  for (const double sign : {1.0, -1.0}) {
    const Vector speed = of_j.col(0) + sign * of_k.col(0);
    const double usual = std::max(speed.norm() / std::sqrt(rows), 1e-300);
    all.col(of_k.cols() + (sign > 0.0 ? 0 : 1)) = (speed / (kSlow * usual)).array().tanh();
  }
  return all;
}

}  // namespace

void warn_of_coupled_drives(const std::vector<PreparedDynamics>& trials, RobotIdentification& found) {
  constexpr double kApart = 1e-7, kBeyondChance = 6.0, kExplains = 0.36, kNegligible = 1e-3;
  const Index n = trials.front().torque.cols();
  const auto lags = static_cast<Index>(std::llround(found.hac_lag_s / trials.front().sample_time));
  const StackedDynamics all = stack_rows(trials, std::nullopt);
  double most = kExplains;
  Index joint = -1, other = -1;
  for (Index j = 0; j < n && n > 1; ++j) {
    const JointRows rows = rows_of_joint(all, found, j);
    if (rows.residual.size() < 4 * rows.own.cols()) continue;
    Vector scale = rows.own.colwise().norm();
    for (double& one : scale) one = one > 0.0 ? 1.0 / one : 0.0;
    const numeric::PivotedQr own(rows.own * scale.asDiagonal(), kApart);
    const Vector left = own.rest(rows.residual);
    double torque = 0.0;
    for (const PreparedDynamics& trial : trials) torque += trial.torque.col(j).squaredNorm();
    for (Index k = 0; k < n; ++k) {
      const Matrix& friction = rows.friction[static_cast<std::size_t>(k)];
      if (k == j || friction.cols() == 0) continue;
      const Matrix beyond =
          own.rest(found.model.drive.viscous ? coupled_friction(rows.friction[static_cast<std::size_t>(j)], friction)
                                             : friction);
      const auto fit = numeric::fit_least_squares(beyond, left);
      if (!fit || fit->rank < beyond.cols()) continue;
      const Vector rest = left - beyond * fit->free;
      const Matrix covariance = numeric::newey_west_covariance(*fit, beyond, rest, all.ranges, lags);
      const double errors = (fit->free.array().abs() / covariance.diagonal().array().max(1e-300).sqrt()).maxCoeff();
      const double explained = 1.0 - rest.squaredNorm() / std::max(left.squaredNorm(), 1e-300);
      const bool matters = (left - rest).norm() > kNegligible * std::sqrt(torque);
      if (!(explained > most && errors > kBeyondChance && matters)) continue;
      most = explained;
      joint = j;
      other = k;
    }
  }
  if (joint < 0) return;
  found.warnings.push_back(
      {WarningCode::missing_dynamics,
       fmt::format("{:.0f} % of the residual torque of joint {} follow the speed of joint {}, as if gears coupled both "
                   "drives; the model has no term for this, so the friction of both joints is biased",
                   100.0 * most, joint + 1, other + 1),
       "correct the coupling in the recorded torques and angles, if the manufacturer states it; do not compute a force "
       "from motion in which both joints turn"});
}

}  // namespace mbk::identify
