#pragma once

#include <functional>

#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/simulate/laboratory/one_axis_loop.h"
#include "mbk/simulate/laboratory/one_axis_sensors.h"
#include "mbk/simulate/laboratory/performance.h"

namespace mbk::laboratory {

/// One trial of a one-axis machine: its servo follows the first axis of the schedule, or its motor exerts it.
struct OneAxisExperiment {
  OneAxisLoop::Machine machine;
  OneAxisLoop::Servo servo;  ///< where the schedule commands positions
  perturbation::Schedule schedule;
  OneAxisSensorOptions sensors;
  Hertz rate{1000.0};
  std::uint64_t seed = 1;                         ///< of the sensors' noise
  std::function<void(double fraction)> progress;  ///< called now and then with the share that is done
};

/// Runs the machine with a limb on it and records position, reaction, reference and acceleration as the sensors see
/// them; tick i = 0, 1, … is at (i + 1)/rate. Angles and torques. Metadata as `perform`.
/// @fails  usage: as OneAxisLoop and OneAxisSensors; a gain or cutoff of the servo is negative.
///         data: the motion does not stay finite, with the time.
[[nodiscard]] Result<Performance> perform(const OneAxisExperiment& experiment, participant::OneAxisLoad& load);

}  // namespace mbk::laboratory
