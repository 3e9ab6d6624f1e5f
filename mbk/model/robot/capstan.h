#pragma once

#include <Eigen/Core>

namespace mbk::robot {

/// Elasticity of the capstan drives: each motor, with its share of the inertia, turns the disc through a cable,
///   I_m θ̈_m = τ − F_r(θ̇_m) − s,   s = k (θ_m − θ) + c (θ̇_m − θ̇)
/// and the links feel the torque s. The encoders sit on the motors. In disc angles throughout.
struct Capstan {
  Eigen::Vector2d stiffness = {400.0, 400.0};      ///< k [N·m/rad] > 0
  Eigen::Vector2d damping = {0.2, 0.2};            ///< c [N·m·s/rad] ≥ 0
  Eigen::Vector2d motor_inertia = {0.015, 0.015};  ///< I_m, taken out of α₁ and α₃ [kg·m²] > 0

  /// s [N·m], what the cables exert on the links.
  [[nodiscard]] Eigen::Vector2d torque(const Eigen::Vector2d& twist, const Eigen::Vector2d& twist_rate) const {
    return stiffness.cwiseProduct(twist) + damping.cwiseProduct(twist_rate);
  }
};

}  // namespace mbk::robot
