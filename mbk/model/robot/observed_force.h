#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/robot/momentum_observer.h"

namespace mbk::robot {

/// The output of a momentum observer over a whole recording, sample by sample as in real time.
struct ObservedForces {
  Matrix joint_torque;         ///< N×n, Jᵀ F_h [N·m, or N where a joint slides]
  Matrix force_hand_on_robot;  ///< N×axes, base frame [N]
  double lag = 0.0;            ///< delay of slow forces [s]
  Index settled = 0;           ///< before this sample more than 1 % of the force at the beginning is missing; at most N
};

/// Causal: no sample depends on later ones.
/// @param position  N×n, of the encoders [rad or m]   @param torque  N×n, of the motors [N·m, or N where a joint
/// slides]
/// @fails  as EncoderMomentumObserver; data: shapes differ, or do not match the robot; a value is not finite, or the
/// posture is singular (the message gives the first such sample).
[[nodiscard]] Result<ObservedForces> observe_force(const DynamicModel& model, const Matrix& position,
                                                   const Matrix& torque,
                                                   const EncoderMomentumObserver::Options& options, double sample_time);

}  // namespace mbk::robot
