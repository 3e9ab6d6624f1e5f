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

/// From recordings of a robot that moves by itself to its dynamics: inspect, prepare, fit. Where the delay is to be
/// found, the torque is shifted and fitted again until the correction is below 1 % of a sample; the Stribeck velocity
/// is the one that leaves least of the torque, by Brent's search over its logarithm about the best of a grid.
/// @param held_out  whole recordings that only judge
/// @fails  as its steps; where a recording has a source, the message names its file.
[[nodiscard]] Result<RobotIdentification> identify_robot(std::span<const Recording> recordings,
                                                         std::span<const Recording> held_out,
                                                         const robot::DynamicModel& model, const RobotOptions& options);

}  // namespace mbk::measurement
