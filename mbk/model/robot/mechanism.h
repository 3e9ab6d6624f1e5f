#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::robot {

inline constexpr int kMaxJoints = 8;

/// One number for each joint [rad, or m where it slides]; never on the heap.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxJoints>;
/// Along the axes in which the hand is measured: one to three.
using HandVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
using HandMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using HandJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, kMaxJoints>;

/// A coefficient in which the dynamics are linear.
struct Coefficient {
  std::string name;
  std::string unit;
};

/// A motion of all joints, sample by sample.
struct JointMotion {
  Matrix position;      ///< N×n [rad or m]
  Matrix velocity;      ///< N×n [rad/s or m/s]
  Matrix acceleration;  ///< N×n [rad/s² or m/s²]

  [[nodiscard]] Index samples() const { return position.rows(); }
};

/// Infinite where there is no limit [rad, or m where the joint slides].
struct JointRange {
  double low = 0.0;
  double high = 0.0;
};

/// A symmetric matrix, linear in the coefficients, that is positive definite for every physically possible robot.
struct PhysicalCondition {
  std::string name;             ///< subject of the condition: a link, or a coefficient
  Matrix A;                     ///< n²×(number of coefficients): A φ is the matrix, column by column
  bool pseudo_inertia = false;  ///< it is the condition of a rigid body (rigid_body.h)
};

/// I(q), Cᵀ(q, q̇) q̇ and g(q) in one state.
struct JointTerms {
  JointMatrix inertia;              ///< n×n [kg·m²; kg where a joint slides]
  JointVector coriolis_transposed;  ///< Cᵀ q̇ = ½ ∂(q̇ᵀ I q̇)/∂q [N·m or N]
  JointVector gravity;              ///< g(q) [N·m or N]
};

/// The bodies of a robot: where its hand is, and the torque of its inertia and weight, which is linear in p
/// coefficients φ (Khosla & Kanade 1985; Dyck 2013, eq. A.5):
///   I(q) q̈ + C(q, q̇) q̇ + g(q) = Y(q, q̇, q̈) φ                                  [N·m, or N where a joint slides]
/// Joint angles are those of the recording; the hand is in the base frame. For the drives see drive_terms.h. Pure
/// functions of state; those of one state do not allocate unless stated.
class Mechanism {
 public:
  virtual ~Mechanism() = default;

  /// n, 1 … kMaxJoints.
  [[nodiscard]] virtual int joints() const = 0;
  /// Name of the joint; "1", "2", … by default.
  [[nodiscard]] virtual std::string joint_name(int joint) const;
  /// Joint names of the description, in order; none if it has none.
  [[nodiscard]] virtual std::vector<std::string> joint_names() const { return {}; }
  /// Range of the joint alone; check_joints may be stricter.
  [[nodiscard]] virtual JointRange joint_range(int joint) const = 0;
  /// The joint's coordinate is a length.
  [[nodiscard]] virtual bool slides(int joint) const = 0;
  /// Of the hand: 1, 2 or 3.
  [[nodiscard]] virtual int hand_axes() const = 0;
  /// φ, p of them.
  [[nodiscard]] virtual const std::vector<Coefficient>& coefficients() const = 0;

  /// Conditions for physically possible φ; none if unknown.
  [[nodiscard]] virtual std::vector<PhysicalCondition> physical_conditions() const { return {}; }
  /// The φ stated in the robot description; empty if none.
  [[nodiscard]] virtual const Vector& stated_coefficients() const;

  /// Y in one state, n×p.
  virtual void regressor(const JointVector& position, const JointVector& velocity, const JointVector& acceleration,
                         Eigen::Ref<Matrix> Y) const = 0;
  /// Y of a motion: N×p for each joint. Allocates.
  [[nodiscard]] virtual std::vector<Matrix> regressors(const JointMotion& motion) const;
  /// By differences of the regressor, unless a mechanism overrides it. Allocates unless overridden.
  [[nodiscard]] virtual JointTerms terms(const JointVector& position, const JointVector& velocity,
                                         const Vector& phi) const;

  /// Of the hand from the base [m].
  [[nodiscard]] virtual HandVector hand_position(const JointVector& position) const = 0;
  /// ∂p/∂q, axes×n [m; 1 where a joint slides].
  [[nodiscard]] virtual HandJacobian jacobian(const JointVector& position) const = 0;
  /// ∂p/∂q along the other axes of the base, in which a force may also act, n columns; no rows if none can.
  [[nodiscard]] virtual HandJacobian jacobian_across(const JointVector& /*position*/) const {
    return HandJacobian(0, joints());
  }
  /// The hand's one coordinate is an angle [rad] and its force a torque [N·m].
  [[nodiscard]] virtual bool hand_turns() const { return false; }
  /// Of the base: "x", "y" or "z".
  [[nodiscard]] virtual std::string hand_axis_name(int axis) const { return axis == 0 ? "x" : "y"; }
  /// dJ/dt.
  [[nodiscard]] virtual HandJacobian jacobian_rate(const JointVector& position, const JointVector& velocity) const = 0;

  /// Whether the posture is within the limits.
  /// @fails  data: a joint is beyond its limits (the message gives the worst and by how much), or not finite.
  [[nodiscard]] virtual Result<void> check_joints(const JointVector& position) const = 0;
  /// Joint positions spread evenly within the limits, up to `per_joint` along each joint. Allocates.
  [[nodiscard]] virtual std::vector<JointVector> postures(int per_joint) const = 0;

 protected:  // copied only as what they are
  Mechanism() = default;
  Mechanism(const Mechanism&) = default;
  Mechanism(Mechanism&&) = default;
  Mechanism& operator=(const Mechanism&) = default;
  Mechanism& operator=(Mechanism&&) = default;
};

}  // namespace mbk::robot
