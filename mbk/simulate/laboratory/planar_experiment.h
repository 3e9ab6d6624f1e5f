#pragma once

#include <cstdint>
#include <functional>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/simulate/laboratory/closed_loop.h"
#include "mbk/simulate/laboratory/performance.h"
#include "mbk/simulate/laboratory/sensors.h"

namespace mbk::laboratory {

using control::ForceMode;
using control::LineMode;
using control::PositionMode;

/// One trial of the planar robot: everything but what hangs at its handle.
struct Experiment {
  ClosedLoop::Options robot;
  Vector2d home = {0.3, -0.05};  ///< the test location: where the hand starts and the schedule is about [m], base frame
  perturbation::Schedule schedule;
  control::Mode control;
  SensorOptions sensors;
  Hertz rate{1000.0};                             ///< of control and recording
  std::uint64_t seed = 1;                         ///< of the sensors' noise
  std::function<void(double fraction)> progress;  ///< called now and then with the share that is done
  std::function<void(const TrueState&)> watch;    ///< called with the truth of each tick, for studies and plots
};

/// Runs the closed loop of robot, controller and load, and records what the sensors see. Tick i = 0, 1, … is at
/// (i + 1)/rate unless the clock jitters. The recording has hand_x … acceleration_y, joint_1, joint_2, torque_1 and
/// torque_2; reference is the hand's place [m] in position mode, else the commanded force [N]. The metadata hold the
/// truth: truth_M, truth_B, truth_K, truth_x0 (the load's intrinsic impedance about home, without the handle, averaged
/// over the trial, as JSON arrays with 12 digits), truth_energy_absorbed_J and truth_force_delay_s of the sensor; and
/// handle_mass_kg, rate_hz, and force_samples_clipped where there are any. Nothing that measures reads them.
/// @fails  usage: as TrialControl, ClosedLoop and SensorSuite. data: the hand leaves the workspace or the motion does
/// not stay finite,
///         with the time.
[[nodiscard]] Result<Performance> perform(const Experiment& experiment, participant::Load& load);

}  // namespace mbk::laboratory
