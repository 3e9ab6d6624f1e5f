#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbk/model/robot/drive_terms.h"
#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

/// Bodies and drives with the coefficients of one robot:
///   Y(q, q̇, q̈) φ + D(q, q̇, q̈) ψ = W θ = τ + Jᵀ F_h,   θ = [φ; ψ]                (Dyck 2013, eq. 5.1)
/// τ the motor torques [N·m, or N where a joint slides], F_h the force that the hand exerts on the robot [N].
struct DynamicModel {
  std::shared_ptr<const Mechanism> mechanism;
  DriveTerms drive;
  Vector parameters;   ///< θ, in the order of `coefficients`
  Matrix covariance;   ///< of θ; empty if unknown
  double delay = 0.0;  ///< delay of the motors after the recorded torque [s]

  [[nodiscard]] std::vector<Coefficient> coefficients() const;

  /// Conditions for a physically possible θ: of its bodies, then of its drives.
  [[nodiscard]] std::vector<PhysicalCondition> physical_conditions() const;

  /// W for a motion, N×(size of θ) for each joint.
  [[nodiscard]] std::vector<Matrix> regressors(const JointMotion& motion) const;

  /// W θ, N×n: the motor torques of a motion with nothing at the hand.
  [[nodiscard]] Matrix torques(const JointMotion& motion) const;

  /// D ψ in one state; does not allocate.
  [[nodiscard]] JointVector drive_torque(const JointVector& position, const JointVector& velocity,
                                         const JointVector& acceleration) const;

 private:
  [[nodiscard]] Index bodies() const { return static_cast<Index>(mechanism->coefficients().size()); }
};

/// Converts the unexplained joint torque to the force at the hand, F_h = L (W θ − τ): the inverse of Jᵀ or, with more
/// joints than axes, the least-squares inverse (J Jᵀ)⁻¹ J, which treats the part outside the range of Jᵀ as error. A
/// force perpendicular to the axes of the hand that the joints can distinguish is not attributed to these axes: its
/// part of the torque is removed. If the joints cannot distinguish it (less than a tenth of J would remain), no such
/// force is assumed, and no moment at the hand.
/// @returns L, axes×n [1/m]
/// @fails  data: the posture is singular: the smallest singular value of J is below 10⁻³ of the largest (the message
/// gives the joint positions).
[[nodiscard]] Result<HandJacobian> hand_from_joints(const Mechanism& mechanism, const JointVector& position);

/// Number of directions perpendicular to the hand axes in which the joints can distinguish a force.
[[nodiscard]] Index told_across(const Mechanism& mechanism, const JointVector& position);

/// The same L for a real-time loop; nothing if the posture is singular. Does not allocate.
[[nodiscard]] std::optional<HandJacobian> regular_hand_from_joints(const Mechanism& mechanism,
                                                                   const JointVector& position) noexcept;

}  // namespace mbk::robot
