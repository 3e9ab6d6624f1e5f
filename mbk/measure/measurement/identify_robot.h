#pragma once

#include <optional>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/identify/robot_fit.h"
#include "mbk/measure/preprocess/prepare_dynamics.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::measurement {

struct RobotOptions {
  preprocess::DynamicsOptions preprocess;
  identify::RobotFitOptions fit;
  bool stribeck_velocity = false;  ///< find it too, where there is a Stribeck term
  std::optional<Hertz> resample;   ///< put the samples on an even clock first
};

/// Dynamics of a robot from recordings of it moving without a hand: inspect, prepare, fit. If the delay is estimated,
/// the torque is shifted and refitted until the correction is below 1 % of a sample; the Stribeck velocity minimises
/// the residual torque, with Brent's search over its logarithm around the best of a grid.
/// @param held_out  whole recordings used only for validation
/// @fails  as its steps; the message names the file if a recording has a source.
[[nodiscard]] Result<RobotIdentification> identify_robot(std::span<const Recording> recordings,
                                                         std::span<const Recording> held_out,
                                                         const robot::DynamicModel& model, const RobotOptions& options);

}  // namespace mbk::measurement
