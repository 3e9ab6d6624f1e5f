#pragma once

#include <vector>

#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

/// Torque of the drive of each joint in addition to that of the bodies, linear in its coefficients ψ:
///   J_m q̈ + b q̇ + [f_c + f_Δ e^{−(q̇/ω_s)²}] tanh(q̇/ω_t) + k q + c                  [N·m, or N where a joint slides]
/// motor inertia J_m (of a mechanism that does not hold it already), viscous b (α₄, α₅ of Dyck 2013, A.6), Coulomb f_c,
/// Stribeck f_Δ = f_s − f_c, a cable or spring k (q − q₀) and an offset c, which includes −k q₀. The same terms for
/// every joint.
struct DriveTerms {
  bool motor_inertia = false;
  bool viscous = true;
  bool coulomb = true;
  bool stribeck = false;
  bool cable = false;
  bool offset = true;
  double smoothing = 0.02;          ///< ω_t [rad/s or m/s] ≥ 0; 0: the sign function
  double stribeck_velocity = 0.05;  ///< ω_s [rad/s or m/s] > 0

  /// ψ, joint by joint: motor_inertia_1, viscous_1, coulomb_1, …
  [[nodiscard]] std::vector<Coefficient> coefficients(const Mechanism& mechanism) const;
  [[nodiscard]] int per_joint() const;

  /// Conditions for a physically possible ψ: J_m, b and f_c above 0, and friction that opposes motion also near
  /// standstill, f_c + f_Δ > 0.
  [[nodiscard]] std::vector<PhysicalCondition> physical_conditions(const Mechanism& mechanism) const;

  /// The terms of one joint, per_joint() of them.
  void regressor(double position, double velocity, double acceleration, double* row) const;

  /// The same for N samples at once, N×per_joint(); it differs from single samples by rounding only.
  void regressors(const Eigen::Ref<const Vector>& position, const Eigen::Ref<const Vector>& velocity,
                  const Eigen::Ref<const Vector>& acceleration, Eigen::Ref<Matrix> rows) const;
};

}  // namespace mbk::robot
