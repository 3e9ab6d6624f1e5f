#include "mbk/simulate/participant/arm_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mbk::participant {
namespace {

/// A link of the given length at an angle against the base frame.
Vector2d link(double length, double angle) {
  return length * Vector2d(std::cos(angle), std::sin(angle));
}

/// A quarter turn ahead: d/dα of link(l, α).
Vector2d turned(const Vector2d& v) {
  return {-v.y(), v.x()};
}

Matrix2d columns(const Vector2d& first, const Vector2d& second) {
  return (Matrix2d() << first, second).finished();
}

}  // namespace

ArmLinks arm_links(const ArmGeometry& geometry, const Vector2d& q) {
  return {link(geometry.upper_arm, geometry.rotation + q[0]), link(geometry.forearm, geometry.rotation + q[0] + q[1])};
}

Matrix2d jacobian(const ArmLinks& links) {
  return columns(turned(links.upper_arm + links.forearm), turned(links.forearm));
}

Matrix2d jacobian_rate(const ArmLinks& links, const Vector2d& q_rate) {
  const Vector2d forearm = -(q_rate[0] + q_rate[1]) * links.forearm;
  return columns(forearm - q_rate[0] * links.upper_arm, forearm);
}

Vector2d hand_position(const ArmGeometry& geometry, const Vector2d& q) {
  const ArmLinks at = arm_links(geometry, q);
  return geometry.shoulder + at.upper_arm + at.forearm;
}

Vector2d elbow_position(const ArmGeometry& geometry, const Vector2d& q) {
  return geometry.shoulder + arm_links(geometry, q).upper_arm;
}

Matrix2d jacobian(const ArmGeometry& geometry, const Vector2d& q) {
  return jacobian(arm_links(geometry, q));
}

Matrix2d jacobian_rate(const ArmGeometry& geometry, const Vector2d& q, const Vector2d& q_rate) {
  return jacobian_rate(arm_links(geometry, q), q_rate);
}

Matrix2d force_curvature(const ArmGeometry& geometry, const Vector2d& q, const Vector2d& force) {
  const ArmLinks at = arm_links(geometry, q);
  const double forearm = -force.dot(at.forearm);
  return (Matrix2d() << forearm - force.dot(at.upper_arm), forearm, forearm, forearm).finished();
}

Vector2d joint_angles(const ArmGeometry& geometry, const Vector2d& hand) {
  const double l1 = geometry.upper_arm, l2 = geometry.forearm;
  const Vector2d p = Eigen::Rotation2Dd(-geometry.rotation) * (hand - geometry.shoulder);
  const double cosine = std::clamp((p.squaredNorm() - l1 * l1 - l2 * l2) / (2.0 * l1 * l2), -1.0, 1.0);
  const double q2 = std::clamp(std::acos(cosine), kSmallestElbowAngle, std::numbers::pi - kSmallestElbowAngle);
  // Measured from straight ahead, so that the angle jumps only behind the person
  const double toward_hand = 0.5 * std::numbers::pi - std::atan2(p.x(), p.y());
  return {toward_hand - std::atan2(l2 * std::sin(q2), l1 + l2 * std::cos(q2)), q2};
}

}  // namespace mbk::participant
