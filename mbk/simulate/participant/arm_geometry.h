#pragma once

#include <Eigen/Core>

namespace mbk::participant {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Position and lengths of a two-link arm. Its axes: origin at the shoulder, x to the person's right, y forward,
/// rotated relative to the base frame. q₁ turns the upper arm from the arm's x axis, q₂ the forearm against the upper
/// arm; 0 < q₂ < π keeps the elbow to the right of the line from shoulder to hand.
struct ArmGeometry {
  double upper_arm = 0.31;            ///< l₁ [m] > 0
  double forearm = 0.34;              ///< l₂, elbow to the middle of the grip [m] > 0
  Vector2d shoulder = {0.30, -0.57};  ///< base frame [m]
  double rotation = 0.0;              ///< φ, of the arm's axes against the base frame [rad]
};

/// p = shoulder + R(φ) [l₁ cos q₁ + l₂ cos(q₁+q₂), l₁ sin q₁ + l₂ sin(q₁+q₂)], the hand in the base frame [m].
[[nodiscard]] Vector2d hand_position(const ArmGeometry& geometry, const Vector2d& q);

/// The elbow in the base frame [m].
[[nodiscard]] Vector2d elbow_position(const ArmGeometry& geometry, const Vector2d& q);

/// Shoulder to elbow and elbow to hand, base frame [m], used for J and J̇.
struct ArmLinks {
  Vector2d upper_arm, forearm;
};
[[nodiscard]] ArmLinks arm_links(const ArmGeometry& geometry, const Vector2d& q);
[[nodiscard]] Matrix2d jacobian(const ArmLinks& links);
[[nodiscard]] Matrix2d jacobian_rate(const ArmLinks& links, const Vector2d& q_rate);

/// Σ_k F_k ∂²p_k/∂q² [N·m]: change of the joint torque of a constant force [N] (base frame) with the joints. Symmetric.
[[nodiscard]] Matrix2d force_curvature(const ArmLinks& links, const Vector2d& force);

/// J = ∂p/∂q [m]; det J = l₁l₂ sin q₂.
[[nodiscard]] Matrix2d jacobian(const ArmGeometry& geometry, const Vector2d& q);

/// J̇ = dJ/dt [m/s].
[[nodiscard]] Matrix2d jacobian_rate(const ArmGeometry& geometry, const Vector2d& q, const Vector2d& q_rate);

/// The forearm against the upper arm: cos q₂ and sin q₂.
struct Elbow {
  double cosine, sine;

  [[nodiscard]] static Elbow at(double angle);  ///< [rad]
};

/// The arm with the hand at one position. Sines and cosines of q follow from the triangle of shoulder, elbow and hand.
struct Posture {
  Vector2d q;  ///< [rad]
  Elbow elbow;
  ArmLinks links;
};

/// The posture for a hand position, elbow to the right:
///   q₂ = acos((r² − l₁² − l₂²)/(2 l₁l₂)),  q₁ = α − atan2(l₂ sin q₂, l₁ + l₂ cos q₂)
/// with (x, y) the hand in the arm's axes, r its distance, α = 90° − atan2(x, y) its direction, −90° ≤ α < 270°. A
/// position out of reach gives the posture towards it whose elbow is `kSmallestElbowAngle` from straight or from
/// folded, so that J always has an inverse; the shoulder itself gives the posture towards the y axis of the base frame.
[[nodiscard]] Posture posture(const ArmGeometry& geometry, const Vector2d& hand);

/// Its q alone.
[[nodiscard]] Vector2d joint_angles(const ArmGeometry& geometry, const Vector2d& hand);

inline constexpr double kSmallestElbowAngle = 0.05;  ///< [rad]

}  // namespace mbk::participant
