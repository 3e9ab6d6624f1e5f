#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "mbk/base/core/result.h"
#include "mbk/model/impedance/model.h"
#include "mbk/model/perturbation/jet.h"

namespace mbk::participant {

/// Passive mechanics of a right arm in space with three joints, so that the hand determines them: plane of elevation
/// q₁ and elevation q₂ of the upper arm at the shoulder, and flexion q₃ of the elbow. The rotation ψ of the upper arm
/// about its own axis is constant, and so is the wrist.
///   I(q) q̈ + C(q, q̇) q̇ + D_q q̇ + K_q (q − q₀) = −Jᵀ F_h
/// F_h the force that the hand exerts on the robot. The arm's weight is carried: no gravity. Base frame: x to the
/// person's right, y forward, z up. q = 0 is the straight arm that hangs down; q₁ turns the plane of elevation about z
/// from the side (0) to the front (90°), q₂ lifts the upper arm in it, q₃ bends the forearm in that plane too if ψ = 0,
/// and towards the middle of the body if ψ = 90° (internal rotation).
/// Masses, centres and radii of gyration are those of de Leva (1996), table 4, men, with the mean of sagittal and
/// transverse radius; forearm and hand are one body, gripping at the centre of the hand.
class SpatialArm {
 public:
  struct Options {
    double body_mass = 73.0;    ///< of the person [kg]
    double upper_arm = 0.2817;  ///< shoulder to elbow [m]
    double forearm = 0.337;     ///< elbow to the middle of the grip [m]
    /// q with the hand at home [rad]: 75°, 45°, 85°, the hand 0.44 m before the shoulder, 0.13 m towards the middle.
    Eigen::Vector3d posture = {1.3089969389957472, 0.7853981633974483, 1.4835298641951802};
    double axial_rotation = 0.7853981633974483;  ///< ψ: 45° [rad]
    Eigen::Matrix3d damping = (Eigen::Matrix3d() << 1.45, 0.3, 0.5, 0.3, 1.45, 0.5, 0.5, 0.5, 0.5).finished();
    Eigen::Matrix3d stiffness = (Eigen::Matrix3d() << 11.0, 2.0, 2.9, 2.0, 11.0, 2.9, 2.9, 2.9, 4.8).finished();
    std::optional<Eigen::Vector3d> equilibrium;  ///< rest position of the hand [m], determines q₀; absent: home
  };

  /// @param home  hand position of the posture [m], which determines where the shoulder is
  /// @fails  usage: a mass or length is not above zero; a number is not finite; the posture is not one of those that
  /// joint_angles finds, or is singular; the equilibrium is out of reach.
  [[nodiscard]] static Result<SpatialArm> create(const Options& options, const Eigen::Vector3d& home);

  /// F_h [N] of a hand that moves like this [m, m/s, m/s²]. Not finite out of reach. Does not allocate.
  [[nodiscard]] Eigen::Vector3d force(const perturbation::Jet<perturbation::AxesVector>& hand) const;

  /// Linearised about a position at which the arm is held at rest:
  ///   M = J⁻ᵀ I J⁻¹,  B = J⁻ᵀ D_q J⁻¹,  K = J⁻ᵀ (K_q + Σ F_k ∂²p_k/∂q²) J⁻¹,  K (x − x₀) = −F,  F = −J⁻ᵀ K_q (q − q₀)
  [[nodiscard]] impedance::Model impedance(const Eigen::Vector3d& hand) const;

  /// The q for a hand position, in closed form: elbow from the distance to the shoulder, 0 < q₃ < π; of the two
  /// elevations the one whose plane of elevation contains the hand on the side of q₁. NaN out of reach.
  [[nodiscard]] Eigen::Vector3d joint_angles(const Eigen::Vector3d& hand) const;

  [[nodiscard]] Eigen::Vector3d hand_position(const Eigen::Vector3d& q) const;  ///< [m]

 private:
  /// Joint axes in the columns, and unit vectors along the links, base frame.
  struct Pose {
    Eigen::Matrix3d axes;
    Eigen::Vector3d upper_arm, forearm;
  };
  /// A body that is symmetric about its link.
  struct Body {
    bool beyond_elbow;
    double mass, distance, transverse, axial;  // [kg], of the centre from the link's joint [m], moments [kg·m²]
  };
  /// Angular velocities and accelerations of both links.
  struct Turning {
    std::array<Eigen::Vector3d, 2> velocity, acceleration;
  };

  SpatialArm(const Options& options, const Eigen::Vector3d& home);
  [[nodiscard]] Pose pose(const Eigen::Vector3d& q) const;
  [[nodiscard]] Eigen::Vector3d place(const Pose& at, bool beyond_elbow, double distance) const;
  [[nodiscard]] Eigen::Matrix3d jacobian(const Pose& at, bool beyond_elbow, double distance) const;
  [[nodiscard]] Eigen::Vector3d acceleration(const Pose& at, const Turning& turning, bool beyond_elbow,
                                             double distance) const;
  [[nodiscard]] Eigen::Vector3d elastic_torque(const Eigen::Vector3d& q) const;

  Options options_;
  std::array<Body, 3> bodies_;
  Eigen::Vector3d shoulder_, q0_;
};

}  // namespace mbk::participant
