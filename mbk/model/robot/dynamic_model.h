#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbk/model/robot/drive_terms.h"
#include "mbk/model/robot/mechanism.h"

namespace mbk::robot {

/// Bodies and drives with the numbers that make them one robot:
///   Y(q, q̇, q̈) φ + D(q, q̇, q̈) ψ = W θ = τ + Jᵀ F_h,   θ = [φ; ψ]                (Dyck 2013, eq. 5.1)
/// τ the motor torques [N·m, or N where a joint slides], F_h the force that the hand exerts on the robot [N].
struct DynamicModel {
  std::shared_ptr<const Mechanism> mechanism;
  DriveTerms drive;
  Vector parameters;   ///< θ, in the order of `coefficients`
  Matrix covariance;   ///< of θ; empty where it is not known
  double delay = 0.0;  ///< by which the motors act after the torque that is recorded [s]

  [[nodiscard]] std::vector<Coefficient> coefficients() const;

  /// What holds for the θ of any robot that can exist: of its bodies, then of its drives.
  [[nodiscard]] std::vector<PhysicalCondition> physical_conditions() const;

  /// W of a motion, N×θ for each joint.
  [[nodiscard]] std::vector<Matrix> regressors(const JointMotion& motion) const;

  /// W θ, N×n: the motor torques of a motion with nothing at the hand.
  [[nodiscard]] Matrix torques(const JointMotion& motion) const;

  /// D ψ in one state; does not allocate.
  [[nodiscard]] JointVector drive_torque(const JointVector& position, const JointVector& velocity,
                                         const JointVector& acceleration) const;

 private:
  [[nodiscard]] Index bodies() const { return static_cast<Index>(mechanism->coefficients().size()); }
};

/// What turns a torque that is missing at the joints into the force at the hand, F_h = L (W θ − τ): the inverse of Jᵀ,
/// or where there are more joints than axes the least-squares one, (J Jᵀ)⁻¹ J, which takes what J cannot pass for
/// error. A push across the axes of the hand, of which the joints know, is not taken for one along them: its part of
/// the torque is left out of both. Where the joints cannot tell it apart (less than a tenth of J would be left), none
/// is assumed; nor is a moment at the hand.
/// @returns L, axes×n [1/m]
/// @fails  data: the posture is singular: the smallest singular value of J is below 10⁻³ of the largest (the joints are
/// named).
[[nodiscard]] Result<HandJacobian> hand_from_joints(const Mechanism& mechanism, const JointVector& position);

/// In how many directions across the hand's axes the joints tell a push from one along them.
[[nodiscard]] Index told_across(const Mechanism& mechanism, const JointVector& position);

/// The same L for a loop that cannot wait for words; nothing where the posture is singular. Does not allocate.
[[nodiscard]] std::optional<HandJacobian> regular_hand_from_joints(const Mechanism& mechanism,
                                                                   const JointVector& position) noexcept;

}  // namespace mbk::robot
