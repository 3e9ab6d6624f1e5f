#pragma once

#include <array>
#include <vector>

#include "mbk/model/robot/dynamics.h"

namespace mbk::robot {

/// How far the joints are from one of their limits.
struct Margin {
  const char* quantity;  ///< "θ₁", "θ₂", "θ₁ − (θ₂ − 90°)"
  double value = 0;      ///< of the quantity [rad]
  double limit = 0;      ///< [rad]
  bool upper = false;    ///< the quantity may not exceed the limit; otherwise not fall below it
  /// What is left before the limit; negative beyond it [rad].
  [[nodiscard]] double left() const { return upper ? limit - value : value - limit; }
};

/// All five, in the order of JointLimits. Each is measured in the angle that it limits.
[[nodiscard]] std::array<Margin, 5> margins(const JointLimits& limits, const Vector2d& theta);

/// The least of them [rad]; negative where the robot cannot be.
[[nodiscard]] double margin(const JointLimits& limits, const Vector2d& theta);

/// Whether the robot can stand at θ. On the limit counts as inside, to a rounding of 10⁻⁹ rad.
/// @fails  usage: an angle is not finite, or is beyond a limit (the worst is named, and by how many degrees).
[[nodiscard]] Result<void> check_joints(const JointLimits& limits, const Vector2d& theta);

/// The joint angles that bring the hand to a place within the limits.
/// @fails  usage: as joint_angles, as check_joints; the message begins with the place.
[[nodiscard]] Result<Vector2d> check_hand(const Geometry& geometry, const Vector2d& hand);

/// The corners of the set of joint angles that the limits leave, anticlockwise in the plane of (θ₁, θ₂) [rad]; corners
/// that coincide stand once. Exact: where two limits meet, both hold with equality. Empty where the limits leave
/// nothing.
[[nodiscard]] std::vector<Vector2d> joint_space_corners(const JointLimits& limits);

/// The outline of the places that the hand can reach: the edges of the joint space, mapped by the forward kinematics.
/// That is the outline because the map is one to one as long as |θ₁ − θ₂| ≤ 90°.
/// @param points  along the whole outline, at least 3; every corner is one of them besides
/// @returns  a closed line, its last point being its first, base frame [m]
/// @fails  usage: d₁ or d₂ is not positive; the limits leave no area, or reach beyond |θ₁ − θ₂| = 90°; points < 3.
[[nodiscard]] Result<std::vector<Vector2d>> boundary(const Geometry& geometry, int points);

/// A = ½ |Σ (x_i y_{i+1} − x_{i+1} y_i)|, by Green's theorem, of a closed line that does not cross itself.
[[nodiscard]] double enclosed_area(const std::vector<Vector2d>& closed_line);

/// Where the hand can be.
struct Workspace {
  Geometry geometry;
  std::vector<Vector2d> outline;  ///< closed [m], base frame
  Vector2d low, high;             ///< the corners of the rectangle around it [m]
  double area = 0;                ///< [m²]
};

/// @fails  as boundary.
[[nodiscard]] Result<Workspace> workspace(const Geometry& geometry);

/// The robot with its hand at one place.
struct Posture {
  Vector2d hand;                  ///< p_BH, base frame [m]
  Vector2d theta;                 ///< [rad]
  Matrix2d jacobian;              ///< [m]
  double manipulability = 0;      ///< |det J| [m²] (Yoshikawa 1985)
  std::array<Margin, 5> margins;  ///< to the limits of the joints
  Matrix2d inertia_at_hand;       ///< J⁻ᵀ I J⁻¹ [kg]
};

/// @fails  as check_hand, and where the links lie upon each other, as PlanarRobot::inertia_at_hand.
[[nodiscard]] Result<Posture> posture(const PlanarRobot& robot, const Vector2d& hand);

}  // namespace mbk::robot
