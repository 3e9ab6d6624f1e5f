#include "mbk/model/robot/kinematics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mbk::robot {

Vector2d elbow_position(const Geometry& geometry, const Vector2d& theta) {
  return geometry.d1 * Vector2d(std::cos(theta[0]), std::sin(theta[0]));
}

Vector2d hand_position(const Geometry& geometry, const Vector2d& theta) {
  return elbow_position(geometry, theta) + geometry.d2 * Vector2d(std::sin(theta[1]), -std::cos(theta[1]));
}

Matrix2d jacobian(const Geometry& geometry, const Vector2d& theta) {
  Matrix2d J;
  J << -geometry.d1 * std::sin(theta[0]), geometry.d2 * std::cos(theta[1]),  //
      geometry.d1 * std::cos(theta[0]), geometry.d2 * std::sin(theta[1]);
  return J;
}

Matrix2d jacobian_rate(const Geometry& geometry, const Vector2d& theta, const Vector2d& theta_rate) {
  const double first = geometry.d1 * theta_rate[0], last = geometry.d2 * theta_rate[1];
  Matrix2d rate;
  rate << -first * std::cos(theta[0]), -last * std::sin(theta[1]),  //
      -first * std::sin(theta[0]), last * std::cos(theta[1]);
  return rate;
}

Result<Vector2d> joint_angles(const Geometry& geometry, const Vector2d& hand) {
  const double d1 = geometry.d1, d2 = geometry.d2, r = hand.norm();
  if (!(r <= d1 + d2 && r >= std::abs(d1 - d2) && r > 0.0)) {
    return bad_usage(fmt::format("the hand at ({:.4g}, {:.4g}) m is {:.4g} m from the base, not between {:.4g} and "
                                 "{:.4g} m",
                                 hand.x(), hand.y(), r, std::abs(d1 - d2), d1 + d2),
                     "choose a reachable hand position");
  }
  // The angle at the elbow and the one at the base, both in the triangle of base, elbow and hand
  const double elbow = std::acos(std::clamp((d1 * d1 + d2 * d2 - r * r) / (2.0 * d1 * d2), -1.0, 1.0));
  const double base = std::acos(std::clamp((r * r + d1 * d1 - d2 * d2) / (2.0 * d1 * r), -1.0, 1.0));
  const double theta1 = base + std::atan2(hand.y(), hand.x());
  return Vector2d(theta1, theta1 + elbow - 0.5 * std::numbers::pi);
}

Eigen::Matrix2d link_axes(double theta2) {
  const double s = std::sin(theta2), c = std::cos(theta2);
  return (Eigen::Matrix2d() << s, c, -c, s).finished();
}

}  // namespace mbk::robot
