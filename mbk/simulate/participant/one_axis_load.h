#pragma once

#include "mbk/model/impedance/model.h"

namespace mbk::participant {

/// Angle and angular velocity of a machine of one axis.
struct JointState {
  double position = 0.0;  ///< [rad]
  double velocity = 0.0;  ///< [rad/s]
};

/// What a load asks of the machine in one state: it takes the torque  I θ̈ + h  [N·m], so that
///   reaction = −(I θ̈ + h)
/// is what it exerts on the machine.
struct OneAxisDynamics {
  double inertia = 0.0;  ///< I ≥ 0 [kg·m²]
  double bias = 0.0;     ///< h: damping, stiffness, reflexes, minus will [N·m]
};

/// Something that hangs at a machine of one axis: a joint such as ankle or elbow. It decides (reflexes, noise) once a
/// control tick and is a pure function of the joint's state in between. `tick` and `dynamics` do not allocate.
class OneAxisLoad {
 public:
  virtual ~OneAxisLoad() = default;

  /// The tick at time t [s], of length `sample_time` [s], begins. `reaction` [N·m] is what the load exerted on the
  /// machine at the tick before.
  virtual void tick(double t, double sample_time, const JointState& joint, double reaction) = 0;

  /// I and h in a state, with what the last tick decided.
  [[nodiscard]] virtual OneAxisDynamics dynamics(const JointState& joint) const = 0;

  /// The intrinsic impedance for small motions about an angle, 1×1 matrices, without reflexes or noise.
  [[nodiscard]] virtual impedance::Model impedance(double position) const = 0;

 protected:  // copied only as what they are
  OneAxisLoad() = default;
  OneAxisLoad(const OneAxisLoad&) = default;
  OneAxisLoad(OneAxisLoad&&) = default;
  OneAxisLoad& operator=(const OneAxisLoad&) = default;
  OneAxisLoad& operator=(OneAxisLoad&&) = default;
};

}  // namespace mbk::participant
