#include "mbk/model/robot/dynamics.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace mbk::robot {

Inertia Inertia::with_payload(const Geometry& geometry, double mass) const {
  const double d1 = geometry.d1, d2 = geometry.d2;
  return {alpha1 + mass * d1 * d1, alpha2 + 2.0 * mass * d1 * d2, alpha3 + mass * d2 * d2};
}

Vector2d PlanarRobot::friction_torque(const Vector2d& theta_rate) const {
  return {friction[0].torque(theta_rate[0]), friction[1].torque(theta_rate[1])};
}

Vector2d PlanarRobot::acceleration(const Vector2d& theta, const Vector2d& theta_rate, const Vector2d& motor_torque,
                                   const Vector2d& force_hand_on_robot) const {
  const Vector2d torque = motor_torque + jacobian(geometry, theta).transpose() * force_hand_on_robot -
                          friction_torque(theta_rate) - inertia.coriolis(theta, theta_rate) * theta_rate;
  return inertia.matrix(theta).inverse() * torque;
}

Vector2d PlanarRobot::motor_torque(const Vector2d& theta, const Vector2d& theta_rate,
                                   const Vector2d& theta_acceleration, const Vector2d& force_hand_on_robot) const {
  return inertia.matrix(theta) * theta_acceleration + inertia.coriolis(theta, theta_rate) * theta_rate +
         friction_torque(theta_rate) - jacobian(geometry, theta).transpose() * force_hand_on_robot;
}

Result<Matrix2d> PlanarRobot::inertia_at_hand(const Vector2d& theta) const {
  constexpr double kSmallestCosine = 1e-6;
  const double difference = theta[0] - theta[1];
  if (!(std::abs(std::cos(difference)) >= kSmallestCosine)) {
    return bad_usage(
        fmt::format("the links are collinear (θ₁ − θ₂ = {:.4g}°), so no force can move the hand along them",
                    difference * 180.0 / std::numbers::pi),
        "choose another hand position");
  }
  const Matrix2d inverse = jacobian(geometry, theta).inverse();
  return Matrix2d(inverse.transpose() * inertia.matrix(theta) * inverse);
}

double PlanarRobot::kinetic_energy(const Vector2d& theta, const Vector2d& theta_rate) const {
  return 0.5 * theta_rate.dot(inertia.matrix(theta) * theta_rate);
}

}  // namespace mbk::robot
