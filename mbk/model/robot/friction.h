#pragma once

namespace mbk::robot {

/// Friction of one joint, opposing its motion:
///   F_r(ω) = b ω + [f_c + (f_s − f_c) e^{−(ω/ω_s)²}] tanh(ω/ω_t)            [N·m]
/// b viscous (Dyck 2013, eq. A.6: α₄, α₅), f_c Coulomb, f_s breakaway with the Stribeck velocity ω_s. The sign is
/// smoothed over ω_t, so that standstill is a slow creep and the equation of motion remains solvable.
struct JointFriction {
  double viscous = 0.0;             ///< b [N·m·s/rad] ≥ 0
  double coulomb = 0.0;             ///< f_c [N·m] ≥ 0
  double breakaway = 0.0;           ///< f_s [N·m]; below f_c (so also 0) means no Stribeck effect
  double stribeck_velocity = 0.05;  ///< ω_s [rad/s] > 0
  double smoothing = 0.02;          ///< ω_t [rad/s] > 0

  /// The part that does not grow with speed [N·m].
  [[nodiscard]] double dry_torque(double velocity) const;

  /// All of F_r [N·m].
  [[nodiscard]] double torque(double velocity) const { return viscous * velocity + dry_torque(velocity); }
};

}  // namespace mbk::robot
