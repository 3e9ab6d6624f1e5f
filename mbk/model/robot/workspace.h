#pragma once

#include <array>
#include <vector>

#include "mbk/model/robot/dynamics.h"

namespace mbk::robot {

/// Distance of the joints from one of their limits.
struct Margin {
  const char* quantity;  ///< "θ₁", "θ₂", "θ₁ − (θ₂ − 90°)"
  double value = 0;      ///< of the quantity [rad]
  double limit = 0;      ///< [rad]
  bool upper = false;    ///< the quantity may not exceed the limit; otherwise not fall below it
  /// Distance to the limit; negative beyond it [rad].
  [[nodiscard]] double left() const { return upper ? limit - value : value - limit; }
};

/// All five, in the order of JointLimits. Each is measured in the angle that it limits.
[[nodiscard]] std::array<Margin, 5> margins(const JointLimits& limits, const Vector2d& theta);

/// The smallest of them [rad]; negative outside the workspace.
[[nodiscard]] double margin(const JointLimits& limits, const Vector2d& theta);

/// Whether the posture θ is within the limits. The limit itself is inside, with a tolerance of 10⁻⁹ rad.
/// @fails  usage: an angle is not finite, or is beyond a limit (the message gives the worst and by how many degrees).
[[nodiscard]] Result<void> check_joints(const JointLimits& limits, const Vector2d& theta);

/// The joint angles for a hand position within the limits.
/// @fails  usage: as joint_angles, as check_joints; the message begins with the position.
[[nodiscard]] Result<Vector2d> check_hand(const Geometry& geometry, const Vector2d& hand);

/// The corners of the joint space within the limits, anticlockwise in the plane of (θ₁, θ₂) [rad]; coincident corners
/// are listed once. Exact: at a corner two limits are satisfied with equality. Empty if the limits leave no joint
/// space.
[[nodiscard]] std::vector<Vector2d> joint_space_corners(const JointLimits& limits);

/// The outline of the workspace of the hand: the edges of the joint space mapped by the forward kinematics. This is the
/// outline because the map is one-to-one for |θ₁ − θ₂| ≤ 90°.
/// @param points  along the whole outline, at least 3; every corner is added
/// @returns  a closed line whose last point equals the first, base frame [m]
/// @fails  usage: d₁ or d₂ is not positive; the limits leave no area, or extend beyond |θ₁ − θ₂| = 90°; points < 3.
[[nodiscard]] Result<std::vector<Vector2d>> boundary(const Geometry& geometry, int points);

/// A = ½ |Σ (x_i y_{i+1} − x_{i+1} y_i)|, by Green's theorem, of a closed line that does not cross itself.
[[nodiscard]] double enclosed_area(const std::vector<Vector2d>& closed_line);

/// The workspace of the hand.
struct Workspace {
  Geometry geometry;
  std::vector<Vector2d> outline;  ///< closed [m], base frame
  Vector2d low, high;             ///< the corners of the rectangle around it [m]
  double area = 0;                ///< [m²]
};

/// @fails  as boundary.
[[nodiscard]] Result<Workspace> workspace(const Geometry& geometry);

/// The robot with its hand at one position.
struct Posture {
  Vector2d hand;                  ///< p_BH, base frame [m]
  Vector2d theta;                 ///< [rad]
  Matrix2d jacobian;              ///< [m]
  double manipulability = 0;      ///< |det J| [m²] (Yoshikawa 1985)
  std::array<Margin, 5> margins;  ///< to the limits of the joints
  Matrix2d inertia_at_hand;       ///< J⁻ᵀ I J⁻¹ [kg]
};

/// @fails  as check_hand; for collinear links, as PlanarRobot::inertia_at_hand.
[[nodiscard]] Result<Posture> posture(const PlanarRobot& robot, const Vector2d& hand);

}  // namespace mbk::robot
