#pragma once

#include <Eigen/Core>
#include <array>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/impedance/model.h"

namespace mbk::impedance {

/// Kinematics of the hand x over two joints q at one posture.
struct JointMap {
  Eigen::Matrix2d jacobian;                  ///< J = ∂x/∂q [m]
  std::array<Eigen::Matrix2d, 2> curvature;  ///< ∂²x_k/∂q² [m], k = x, y of the base frame; symmetric
};

/// Reference of the elbow angle.
enum class ElbowAngle {
  first_link,  ///< relative to the upper arm, as in an arm
  base,  ///< relative to the base, as in the robot of Dyck (2013), fig. A.1: q₁ does not change the direction of the
         ///< last link
};

/// Two links in a plane, joints counted counter-clockwise. With a from shoulder (or base) to elbow, b from elbow to
/// hand and R a quarter turn ahead,
///   J = [R(a + b), R b],  ∂²x/∂q₁² = −(a + b), ∂²x/∂q₁∂q₂ = ∂²x/∂q₂² = −b    (elbow against the first link)
///   J = [R a, R b],       ∂²x/∂q₁² = −a, ∂²x/∂q₁∂q₂ = 0, ∂²x/∂q₂² = −b        (against the base; Dyck 2013, eq. A.3)
/// @param shoulder, elbow, hand  base frame [m]
[[nodiscard]] JointMap two_link_map(const Eigen::Vector2d& shoulder, const Eigen::Vector2d& elbow,
                                    const Eigen::Vector2d& hand, ElbowAngle angle);

/// The impedance of a hand in joint coordinates.
struct JointImpedance {
  Matrix M;           ///< M_q, 2×2 [kg·m²]
  Matrix B;           ///< B_q, 2×2 [N·m·s/rad]
  Matrix K;           ///< K_q, 2×2 [N·m/rad]
  Vector bias_force;  ///< F, that the hand exerts on the robot at rest in this posture, base frame [N]
  Matrix gradient;    ///< 14×14: ∂[M_q B_q K_q by rows, F]/∂(stacked model of the hand), for the delta method
};

/// M_q = JᵀMJ,  B_q = JᵀBJ,  K_q = JᵀKJ − Σ_k F_k ∂²x_k/∂q²,  F = −K(x − x₀)
/// F is force_hand_on_robot: a hand that pushes outward is stiffer at its joints than JᵀKJ, and one that is pushed is
/// less stiff. Antisymmetric parts carry over as k_a,q = det(J) k_a. Without F the definiteness of the matrices is
/// preserved, so that a limb is passive in both domains or in neither. NaN if x₀ is NaN (K singular).
/// @param hand  with two axes    @param place  x, position of the hand [m]
[[nodiscard]] JointImpedance joint_impedance(const Model& hand, const JointMap& joints, const Eigen::Vector2d& place);

}  // namespace mbk::impedance
