#include "mbk/model/robot/planar_mechanism.h"

#include <cmath>

#include "mbk/model/robot/workspace.h"

namespace mbk::robot {

PlanarMechanism::PlanarMechanism(const Options& options) : options_(options) {
  coefficients_ = {{"alpha1", "kg·m²"}, {"alpha2", "kg·m²"}, {"alpha3", "kg·m²"}};
  if (options_.up) {
    coefficients_.push_back({"gravity_1", "N·m"});
    coefficients_.push_back({"gravity_2", "N·m"});
  }
}

std::vector<PhysicalCondition> PlanarMechanism::physical_conditions() const {
  PhysicalCondition inertia{"the links", Matrix::Zero(4, static_cast<Index>(coefficients_.size()))};
  inertia.A(0, 0) = inertia.A(3, 2) = 1.0;
  inertia.A(1, 1) = inertia.A(2, 1) = 0.5;
  return {std::move(inertia)};
}

JointRange PlanarMechanism::joint_range(int joint) const {
  const JointLimits& limits = options_.geometry.limits;
  return joint == 0 ? JointRange{limits.theta1_low, limits.theta1_high}
                    : JointRange{limits.theta2_low, limits.theta2_high};
}

void PlanarMechanism::regressor(const JointVector& position, const JointVector& velocity,
                                const JointVector& acceleration, Eigen::Ref<Matrix> Y) const {
  const double s = 0.5 * std::sin(position[0] - position[1]), c = 0.5 * std::cos(position[0] - position[1]);
  const double lower_left = options_.coriolis == Coriolis::skew ? -c : c;
  Y.setZero();
  Y(0, 0) = acceleration[0];
  Y(0, 1) = -s * acceleration[1] + c * velocity[1] * velocity[1];
  Y(1, 1) = -s * acceleration[0] + lower_left * velocity[0] * velocity[0];
  Y(1, 2) = acceleration[1];
  if (options_.up) {
    Y(0, 3) = -std::sin(position[0] - *options_.up);
    Y(1, 4) = std::cos(position[1] - *options_.up);
  }
}

std::vector<Matrix> PlanarMechanism::regressors(const JointMotion& motion) const {
  const auto p = static_cast<Index>(coefficients_.size());
  std::vector<Matrix> Y(2, Matrix::Zero(motion.samples(), p));
  const auto &q = motion.position, &v = motion.velocity, &a = motion.acceleration;
  const Eigen::ArrayXd between = q.col(0).array() - q.col(1).array();
  const Eigen::ArrayXd s = 0.5 * between.sin(), c = 0.5 * between.cos();
  const double lower_left = options_.coriolis == Coriolis::skew ? -1.0 : 1.0;
  Y[0].col(0) = a.col(0);
  Y[0].col(1) = -s * a.col(1).array() + c * v.col(1).array().square();
  Y[1].col(1) = -s * a.col(0).array() + lower_left * c * v.col(0).array().square();
  Y[1].col(2) = a.col(1);
  if (options_.up) {
    Y[0].col(3) = -(q.col(0).array() - *options_.up).sin();
    Y[1].col(4) = (q.col(1).array() - *options_.up).cos();
  }
  return Y;
}

JointTerms PlanarMechanism::terms(const JointVector& position, const JointVector& velocity, const Vector& phi) const {
  const Inertia inertia{phi[0], phi[1], phi[2]};
  const Vector2d theta = position, rate = velocity;
  // ½ ∂(θ̇ᵀ I θ̇)/∂θ = −½ α₂ cos(θ₁ − θ₂) θ̇₁ θ̇₂ [1, −1]
  const double slope = -0.5 * inertia.alpha2 * std::cos(theta[0] - theta[1]) * rate[0] * rate[1];
  JointTerms terms{inertia.matrix(theta), Vector2d(slope, -slope), Vector2d::Zero()};
  if (options_.up) {
    terms.gravity << -phi[3] * std::sin(theta[0] - *options_.up), phi[4] * std::cos(theta[1] - *options_.up);
  }
  return terms;
}

HandVector PlanarMechanism::hand_position(const JointVector& position) const {
  return robot::hand_position(options_.geometry, Vector2d(position));
}

HandJacobian PlanarMechanism::jacobian(const JointVector& position) const {
  return robot::jacobian(options_.geometry, Vector2d(position));
}

HandJacobian PlanarMechanism::jacobian_rate(const JointVector& position, const JointVector& velocity) const {
  return robot::jacobian_rate(options_.geometry, Vector2d(position), Vector2d(velocity));
}

Result<void> PlanarMechanism::check_joints(const JointVector& position) const {
  return robot::check_joints(options_.geometry.limits, Vector2d(position));
}

std::vector<JointVector> PlanarMechanism::postures(int per_joint) const {
  const JointLimits& limits = options_.geometry.limits;
  std::vector<JointVector> grid;
  const auto at = [per_joint](double low, double high, int k) {
    return std::lerp(low, high, per_joint == 1 ? 0.5 : k / (per_joint - 1.0));
  };
  for (int i = 0; i < per_joint; ++i) {
    for (int j = 0; j < per_joint; ++j) {
      const Vector2d theta(at(limits.theta1_low, limits.theta1_high, i), at(limits.theta2_low, limits.theta2_high, j));
      if (margin(limits, theta) >= 0.0) grid.emplace_back(theta);
    }
  }
  return grid;
}

}  // namespace mbk::robot
