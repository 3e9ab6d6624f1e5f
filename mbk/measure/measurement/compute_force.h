#pragma once

#include "mbk/base/core/result.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/trial/force_summary.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// A recording with the computed force at the hand.
struct ComputedForce {
  /// The samples at which the force could be computed. To the channels of the recording come force_x, force_y (the
  /// computed force, smoothed but not low-passed; what a sensor recorded moves as it is to sensor_force_x,
  /// sensor_force_y) and, where the robot's coefficients have a covariance, their part of the force's standard error,
  /// force_error_x, force_error_y; with one axis reaction, sensor_reaction, reaction_error.
  Recording recording;
  ForceSummary summary;  ///< sample by sample, through the filters of a measurement
};

/// Uses the options of preprocess and `resample`.
/// @fails  as preprocess::virtual_force
[[nodiscard]] Result<ComputedForce> compute_force(const Recording& recording, const Options& options);

}  // namespace mbk::measurement
