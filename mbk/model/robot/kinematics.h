#pragma once

#include <Eigen/Core>

#include "mbk/base/core/result.h"

namespace mbk::robot {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The ranges of the joints (Dyck 2013, eq. A.2). The first two keep the links from the stops of the capstan disc, the
/// third keeps the links from each other.
struct JointLimits {
  double theta1_low = -0.95993108859688126;      ///< −55° [rad]
  double theta1_high = 1.5707963267948966;       ///< 90° [rad]
  double theta2_low = 0.0;                       ///< [rad]
  double theta2_high = 2.5307274153917776;       ///< 145° [rad]
  double smallest_opening = 0.6108652381980153;  ///< of θ₁ − (θ₂ − 90°): 35° [rad]
};

/// Lengths and limits of a planar robot of two links whose joints are both measured against the base: θ₁ turns the
/// first link from the x axis, θ₂ the last link from the −y axis (Dyck 2013, fig. A.1).
struct Geometry {
  double d1 = 0.254;   ///< first link: 10 in [m] > 0
  double d2 = 0.2667;  ///< last link: 10.5 in [m] > 0
  JointLimits limits;
};

/// p_BH(θ) = [d₁ cos θ₁ + d₂ sin θ₂, d₁ sin θ₁ − d₂ cos θ₂], the hand H from the base, base frame [m]
/// (Dyck 2013, eq. A.1).
[[nodiscard]] Vector2d hand_position(const Geometry& geometry, const Vector2d& theta);

/// The elbow from the base, base frame [m].
[[nodiscard]] Vector2d elbow_position(const Geometry& geometry, const Vector2d& theta);

/// J = ∂p/∂θ = [[−d₁ sin θ₁, d₂ cos θ₂], [d₁ cos θ₁, d₂ sin θ₂]] [m]: v = J θ̇. det J = −d₁d₂ cos(θ₁ − θ₂)
/// (Dyck 2013, eq. A.3).
[[nodiscard]] Matrix2d jacobian(const Geometry& geometry, const Vector2d& theta);

/// J̇ = dJ/dt [m/s]: ẍ = J θ̈ + J̇ θ̇.
[[nodiscard]] Matrix2d jacobian_rate(const Geometry& geometry, const Vector2d& theta, const Vector2d& theta_rate);

/// The joint angles for a hand position, on the branch that the limits allow (Dyck 2013, eq. A.4):
///   θ₁ = atan2(y, x) + acos((r² + d₁² − d₂²)/(2 d₁ r)),  θ₂ = θ₁ + acos((d₁² + d₂² − r²)/(2 d₁d₂)) − 90°,  r = |p|
/// Only the reach is checked here; for joint limits see workspace.h.
/// @fails  usage: the position is farther than d₁ + d₂ or nearer than |d₁ − d₂|, or not finite.
[[nodiscard]] Result<Vector2d> joint_angles(const Geometry& geometry, const Vector2d& hand);

/// R_BS(θ₂) = [[sin θ₂, cos θ₂], [−cos θ₂, sin θ₂]] of the axes of a sensor on the last link: x_s points along it, away
/// from the elbow, y_s is 90° to the left.  v_B = R_BS v_S                   (Dyck 2013, eq. E.4)
[[nodiscard]] Eigen::Matrix2d link_axes(double theta2);

}  // namespace mbk::robot
