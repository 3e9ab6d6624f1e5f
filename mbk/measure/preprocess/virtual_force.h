#pragma once

#include "mbk/measure/preprocess/filters.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// A recording with computed force, and its uncertainty.
struct VirtualForce {
  Recording
      recording;  ///< with the computed force in the place of the sensor's; the hand's place where it was not in it
  Matrix joint_velocity;  ///< N×n [rad/s or m/s]
  double lag = 0;         ///< delay of slow forces [s]; 0 if computed with future samples
  Matrix sensor_force;    ///< N×axes, recorded force; empty if not recorded
  Matrix sensitivity;     ///< N×(axes·p), ∂F/∂θ for each axis [N per unit of θ]; empty if θ has no covariance
  Matrix standard_error;  ///< N×axes [N], of the robot's coefficients alone; empty likewise
  FilterPlan filters;     ///< of the measurement that follows
  Index first = 0, last = 0;  ///< samples [first, last) at which the force was computed; before and after it is held
};

/// Method 1 of Dyck (2013, §5.2.2, with the sign of 5.1): the force of the hand on the robot from motion and torque,
///   F_h = L(q) [W(q, q̇, q̈) θ − τ]
/// not causal. Motion and torque pass the same Savitzky–Golay filter (joint_smoothing.h); q̈ is its second derivative,
/// or with options.acceleration from the sensor J⁻¹ (ẍ − J̇ q̇) (5.3). The low-pass comes later, with that of the motion,
/// so that friction at a reversal loses to it on both sides alike. With ForceSource::observer it is what
/// robot/momentum_observer.h says while the robot runs, late and without any statement of how sure it is; for
/// comparison.
/// @fails  data: a channel is missing; a joint beyond its limits, a singular configuration or a value that is no
/// number, with the time; an uneven clock; torques that must be in another unit.
[[nodiscard]] Result<VirtualForce> virtual_force(const Recording& recording, const Inspection& inspection,
                                                 const robot::DynamicModel& model, const Options& options);

}  // namespace mbk::preprocess
