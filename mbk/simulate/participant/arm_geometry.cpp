#include "mbk/simulate/participant/arm_geometry.h"

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

Matrix2d force_curvature(const ArmLinks& links, const Vector2d& force) {
  const double forearm = -force.dot(links.forearm);
  return (Matrix2d() << forearm - force.dot(links.upper_arm), forearm, forearm, forearm).finished();
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

Elbow Elbow::at(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

Posture posture(const ArmGeometry& geometry, const Vector2d& hand) {
  constexpr double kPi = std::numbers::pi, kAtShoulder = 1e-24;  // [m²], where the direction to the hand is undefined
  const double l1 = geometry.upper_arm, l2 = geometry.forearm;
  const Vector2d p = hand - geometry.shoulder;
  const double squared = p.squaredNorm();
  Posture at;

  // The triangle of shoulder, elbow and hand
  const double cosine = (squared - l1 * l1 - l2 * l2) / (2.0 * l1 * l2);
  at.q[1] = std::clamp(std::acos(std::clamp(cosine, -1.0, 1.0)), kSmallestElbowAngle, kPi - kSmallestElbowAngle);
  const bool reached = at.q[1] > kSmallestElbowAngle && at.q[1] < kPi - kSmallestElbowAngle;
  at.elbow = reached ? Elbow{cosine, std::sqrt((1.0 - cosine) * (1.0 + cosine))} : Elbow::at(at.q[1]);
  const double along = l1 + l2 * at.elbow.cosine, beside = l2 * at.elbow.sine;  // of the hand to the upper arm

  // The upper arm is the way to the hand, turned back by the angle between them
  const Vector2d way = squared < kAtShoulder ? Vector2d(Vector2d::UnitY()) : p;
  const Vector2d upper_arm =
      Vector2d(along * way.x() + beside * way.y(), along * way.y() - beside * way.x()).normalized();
  at.links = {l1 * upper_arm, l2 * (at.elbow.cosine * upper_arm + at.elbow.sine * turned(upper_arm))};

  // q₁ in −90° to 270°, and less by a turn where the direction of the hand would be 270° and more: measured from
  // straight ahead, that one jumps only behind the person
  double q1 = std::atan2(upper_arm.y(), upper_arm.x()) - geometry.rotation;
  q1 -= 2.0 * kPi * std::floor((q1 + 0.5 * kPi) / (2.0 * kPi));
  if (q1 > 0.5 * kPi && q1 + std::atan2(beside, along) >= 1.5 * kPi) q1 -= 2.0 * kPi;
  at.q[0] = q1;
  return at;
}

Vector2d joint_angles(const ArmGeometry& geometry, const Vector2d& hand) {
  return posture(geometry, hand).q;
}

}  // namespace mbk::participant
