#pragma once

#include "mbk/base/core/nan.h"
#include "mbk/base/core/result.h"
#include "mbk/simulate/participant/arm_geometry.h"
#include "mbk/simulate/participant/load.h"

namespace mbk::participant {

/// Inertia of two links in a plane with the shoulder at rest, joints q₁ absolute and q₂ relative:
///   I(q) = [[a + 2b cos q₂, c + b cos q₂], [·, c]]                             [kg·m²]
struct ChainInertia {
  double a = 0.0, b = 0.0, c = 0.0;

  [[nodiscard]] Matrix2d matrix(const Elbow& elbow) const;

  /// C(q, q̇) q̇ = b sin q₂ [−(2 q̇₁ + q̇₂) q̇₂, q̇₁²] [N·m].
  [[nodiscard]] Vector2d coriolis_torque(const Elbow& elbow, const Vector2d& q_rate) const;

  static constexpr double kElbowRange = 0.35;  ///< 20° [rad]

  /// a, b, c of the chain with the inertia I_q at one elbow angle.
  /// @fails  usage: I_q is not symmetric or not finite; |cos q₂| < 0.05, which does not determine b; the chain is not
  /// positive definite, c (a − c) > b² cos² q₂, within kElbowRange of that angle. Inertias measured at one position may
  /// be impossible for a chain in other postures.
  [[nodiscard]] static Result<ChainInertia> from_matrix(const Matrix2d& I_q, double elbow_angle);
};

/// Joint parameters of a relaxed arm (shoulder, elbow). The defaults are approximately those of the first participant
/// of Dyck (2013), tables 3.3 and 3.5, with the hand 0.52 m ahead of the shoulder.
struct JointParameters {
  Matrix2d inertia = (Matrix2d() << 0.36, 0.10, 0.10, 0.072).finished();  ///< I_q [kg·m²], symmetric
  double elbow_angle = 1.2886;                                            ///< q₂ for which `inertia` is valid [rad]
  Matrix2d damping = (Matrix2d() << 1.45, 0.5, 0.5, 0.5).finished();      ///< D_q [N·m·s/rad]
  Matrix2d stiffness = (Matrix2d() << 11.0, 2.9, 2.9, 4.8).finished();    ///< K_q [N·m/rad], any
};

/// The joint matrices of an arm whose hand, resting at x₀ without force, has the impedance M, B, K (base frame):
///   I_q = JᵀMJ,  D_q = JᵀBJ,  K_q = JᵀKJ,  J at x₀
/// The antisymmetric part of K carries over as k_a,q = det(J) k_a.
/// @fails  usage: not two axes; not finite; x₀ is out of the arm's reach.
[[nodiscard]] Result<JointParameters> joint_parameters(const ArmGeometry& geometry, const impedance::Model& hand);

/// Passive mechanics of a planar two-link arm, at any posture:
///   I(q) q̈ + C(q, q̇) q̇ + s_D D_q q̇ + s_K K_q (q − q₀) = −Jᵀ F_h
/// F_h the force that the hand exerts on the robot. Out of reach the arm keeps its last possible posture
/// (`joint_angles`). Quantities that depend only on the hand position are cached for the last position, so an arm must
/// not be used by two threads at once.
class TwoLinkArm : public Load<2> {
 public:
  struct Options {
    ArmGeometry geometry;
    JointParameters joints;
    Vector2d equilibrium = {0.30, -0.05};  ///< rest position of the hand, base frame [m]; determines q₀
  };

  /// @fails  usage: a length is not above zero; a number is not finite; the equilibrium is out of reach; as
  ///         ChainInertia::from_matrix.
  [[nodiscard]] static Result<TwoLinkArm> create(const Options& options);

  /// s_K and s_D ≥ 0, both 1 for the arm as it was created: co-contraction. May change between ticks.
  void scale(double stiffness, double damping) {
    stiffness_scale_ = stiffness;
    damping_scale_ = damping;
  }

  /// Sets the rest position [m], base frame. May change between ticks.
  void rest_at(const Vector2d& place) {
    options_.equilibrium = place;
    q0_ = joint_angles(options_.geometry, place);
  }

  [[nodiscard]] LoadDynamics<2> dynamics(const HandState<2>& hand) const override;

  /// Linearised about a position at which the arm is held at rest, with the current s_K and s_D:
  ///   M = J⁻ᵀ I J⁻¹,  B = J⁻ᵀ s_D D_q J⁻¹,  K = J⁻ᵀ (s_K K_q + Σ F_k ∂²x_k/∂q²) J⁻¹,  F = −J⁻ᵀ s_K K_q (q − q₀)
  /// with F the force of the hand on the robot there, and x₀ the rest position of the linear arm: K (x − x₀) = −F.
  [[nodiscard]] impedance::Model impedance(const Vector2d& hand) const override;

  /// Its K alone; does not allocate.
  [[nodiscard]] Matrix2d stiffness(const Vector2d& hand) const;

  /// ½ q̇ᵀ I q̇ and, for symmetric K_q, ½ s_K (q − q₀)ᵀ K_q (q − q₀) [J].
  [[nodiscard]] double kinetic_energy(const HandState<2>& hand) const;
  [[nodiscard]] double elastic_energy(const Vector2d& hand) const;

  [[nodiscard]] const ArmGeometry& geometry() const { return options_.geometry; }
  [[nodiscard]] const ChainInertia& inertia() const { return inertia_; }

 private:
  TwoLinkArm(const Options& options, const ChainInertia& inertia)
      : options_(options), inertia_(inertia), q0_(joint_angles(options.geometry, options.equilibrium)) {}
  /// The arm with the hand at one position.
  struct AtPlace {
    Vector2d hand = Vector2d::Constant(kNaN);
    Posture posture;
    Matrix2d J_inverse;
    Matrix2d inertia;  // J⁻ᵀ I J⁻¹
  };
  [[nodiscard]] const AtPlace& at(const Vector2d& hand) const;
  [[nodiscard]] Vector2d elastic_torque(const Vector2d& q) const;

  mutable AtPlace last_;
  Options options_;
  ChainInertia inertia_;
  Vector2d q0_;
  double stiffness_scale_ = 1.0, damping_scale_ = 1.0;
};

}  // namespace mbk::participant
