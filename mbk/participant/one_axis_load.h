#pragma once

#include "mbk/impedance/model.h"

namespace mbk::participant {

/// Where the handle of a one-axis machine is and how it moves.
struct OneAxisState {
  double position = 0.0;  ///< [rad or m]
  double velocity = 0.0;  ///< [rad/s or m/s]
};

/// What a load takes from the machine in one state, j ẍ + h [N·m or N]; it exerts −(j ẍ + h) on the machine.
struct OneAxisDynamics {
  double inertia = 0.0;  ///< j ≥ 0 [kg·m² or kg]
  double bias = 0.0;     ///< h: damping, stiffness, reflexes, minus will [N·m or N]
};

/// `Load` for a machine of one axis: decides once a tick, is a pure function in between, never allocates.
class OneAxisLoad {
 public:
  virtual ~OneAxisLoad() = default;

  /// The tick at t [s] begins; `reaction` [N·m or N] is what the load exerted on the machine at the tick before.
  virtual void tick(double t, double sample_time, const OneAxisState& state, double reaction) = 0;
  [[nodiscard]] virtual OneAxisDynamics dynamics(const OneAxisState& state) const = 0;

  /// The intrinsic impedance, 1×1, without reflexes and noise: the truth.
  [[nodiscard]] virtual impedance::Model impedance() const = 0;

 protected:  // copied only as what they are
  OneAxisLoad() = default;
  OneAxisLoad(const OneAxisLoad&) = default;
  OneAxisLoad(OneAxisLoad&&) = default;
  OneAxisLoad& operator=(const OneAxisLoad&) = default;
  OneAxisLoad& operator=(OneAxisLoad&&) = default;
};

}  // namespace mbk::participant
