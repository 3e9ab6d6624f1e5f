#pragma once

#include <array>
#include <cmath>

#include "mbk/model/robot/friction.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::robot {

/// Constants of the inertia matrix (Dyck 2013, eq. A.6 and table A.1).
struct Inertia {
  double alpha1 = 0.06929;  ///< [kg·m²]
  double alpha2 = 0.04217;  ///< [kg·m²]
  double alpha3 = 0.04416;  ///< [kg·m²]

  /// I(θ) = [[α₁, −½α₂ sin(θ₁ − θ₂)], [·, α₃]] [kg·m²].
  [[nodiscard]] Matrix2d matrix(const Vector2d& theta) const {
    const double coupling = -0.5 * alpha2 * std::sin(theta[0] - theta[1]);
    Matrix2d I;
    I << alpha1, coupling, coupling, alpha3;
    return I;
  }

  /// C(θ, θ̇) = ½α₂ cos(θ₁ − θ₂) [[0, θ̇₂], [−θ̇₁, 0]] [N·m·s/rad]. The lower-left sign is the opposite of the printed
  /// (A.6): only then is İ − 2C skew-symmetric and the work of the motors equal to the energy gained by the links.
  [[nodiscard]] Matrix2d coriolis(const Vector2d& theta, const Vector2d& theta_rate) const {
    const double c = 0.5 * alpha2 * std::cos(theta[0] - theta[1]);
    Matrix2d C;
    C << 0.0, c * theta_rate[1], -c * theta_rate[0], 0.0;
    return C;
  }

  /// The same robot with a point mass m [kg] fixed at the hand: α₁ + m d₁², α₂ + 2 m d₁d₂, α₃ + m d₂².
  [[nodiscard]] Inertia with_payload(const Geometry& geometry, double mass) const;
};

/// The rehabilitation robot of the thesis, moving in a horizontal plane:
///   I(θ) θ̈ + C(θ, θ̇) θ̇ + F_r(θ̇) = τ + Jᵀ F_h                             (Dyck 2013, eq. 5.1)
/// τ the motor torques [N·m], F_h the force that the hand exerts on the robot [N], base frame.
struct PlanarRobot {
  Geometry geometry;
  Inertia inertia;
  std::array<JointFriction, 2> friction = {JointFriction{.viscous = 0.06510}, JointFriction{.viscous = 0.07389}};

  /// F_r(θ̇) [N·m].
  [[nodiscard]] Vector2d friction_torque(const Vector2d& theta_rate) const;

  /// θ̈ [rad/s²].
  [[nodiscard]] Vector2d acceleration(const Vector2d& theta, const Vector2d& theta_rate, const Vector2d& motor_torque,
                                      const Vector2d& force_hand_on_robot) const;

  /// τ [N·m] of a motion: eq. 5.1 read the other way.
  [[nodiscard]] Vector2d motor_torque(const Vector2d& theta, const Vector2d& theta_rate,
                                      const Vector2d& theta_acceleration, const Vector2d& force_hand_on_robot) const;

  /// J⁻ᵀ I J⁻¹ [kg], base frame: the apparent mass of the robot at the hand, at rest.
  /// @fails  usage: |cos(θ₁ − θ₂)| < 10⁻⁶, the links are collinear and J has no inverse.
  [[nodiscard]] Result<Matrix2d> inertia_at_hand(const Vector2d& theta) const;

  /// ½ θ̇ᵀ I θ̇ [J].
  [[nodiscard]] double kinetic_energy(const Vector2d& theta, const Vector2d& theta_rate) const;
};

}  // namespace mbk::robot
