#pragma once

#include <cstdint>
#include <functional>
#include <type_traits>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/simulate/laboratory/closed_loop.h"
#include "mbk/simulate/laboratory/one_axis_control.h"
#include "mbk/simulate/laboratory/performance.h"
#include "mbk/simulate/laboratory/sensors.h"

namespace mbk::laboratory {

using control::ForceMode;
using control::LineMode;
using control::PositionMode;

/// Control modes of a robot with this number of axes.
template <int Axes>
using ModeOf = std::conditional_t<Axes == 1, OneAxisMode, control::Mode>;

/// One trial of a robot, without the load at its handle.
template <int Axes>
struct Experiment {
  typename ClosedLoop<Axes>::Options robot;
  AxisVector<Axes> home = AxisVector<Axes>::Zero();  ///< the test location: where the hand starts and the schedule is
                                                     ///< about [m], base frame
  perturbation::Schedule schedule;                   ///< with one axis its first
  ModeOf<Axes> control;
  SensorOptions<Axes> sensors;
  Hertz rate{1000.0};                             ///< of control and recording
  std::uint64_t seed = 1;                         ///< of the sensors' noise
  std::function<void(double fraction)> progress;  ///< called occasionally with the completed fraction
  std::function<void(const TrueState<Axes>&)>
      watch;  ///< called with the true state of each tick, for studies and plots
};

/// Runs the closed loop of robot, controller and load, and records the sensor readings. Tick i = 0, 1, … is at
/// (i + 1)/rate unless the clock jitters. The recording has hand_x … acceleration_y, joint_1, joint_2, torque_1 and
/// torque_2, with one axis position, reaction, reference and acceleration as angles and torques; reference is the hand
/// position [m] in position mode, otherwise the commanded force [N]. The metadata hold the truth: truth_M, truth_B,
/// truth_K, truth_x0 (the load's intrinsic impedance about home, without the handle, averaged over the trial, as JSON
/// arrays with 12 digits) and truth_energy_absorbed_J; rate_hz; and with two axes truth_force_delay_s of the sensor,
/// handle_mass_kg, and force_samples_clipped if there are any. Measurements do not read the truth.
/// In a trial of reaches the reference is the displacement from the predicted path, otherwise zero; every reach has an
/// event `trigger`, and truth_M, truth_B, truth_K and truth_x0 are means over the plateaus of the displacements, at the
/// hand position at that time: K is the slope of the hand force over position, at its velocity and acceleration.
/// @fails  usage: as TrialControl or OneAxisControl, ClosedLoop and SensorSuite. data: the hand leaves the workspace or
///         the motion does not stay finite, with the time.
template <int Axes>
[[nodiscard]] Result<Performance> perform(const Experiment<Axes>& experiment, participant::Load<Axes>& load);

extern template Result<Performance> perform(const Experiment<1>& experiment, participant::Load<1>& load);
extern template Result<Performance> perform(const Experiment<2>& experiment, participant::Load<2>& load);

}  // namespace mbk::laboratory
