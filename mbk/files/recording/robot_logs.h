#pragma once

#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// Assigns meaning and unit to the columns of a log written by a robot's own program, if the header identifies the
/// program. Known programs:
///   libfranka (franka::logToCSV, and logs with more of franka::RobotState under the same names): time in ms; q[k] is
///   joint k+1, tau_J[k] its torque; O_T_EE[12], O_T_EE[13] are the hand's x and y; O_F_ext_hat_K is the force that the
///   robot exerts on its environment (franka/robot_state.h), so the force of the hand is its negative. With three axes
///   also z; a log without q will do, and K_F_ext_hat_K is turned to the base frame by the recorded orientation if
///   O_F_ext_hat_K is missing.
///   RTDE clients of Universal Robots, with three axes: actual_TCP_pose_0 to _2 are the hand's position,
///   actual_TCP_force_0 to _2 its force, both in the base frame (Universal Robots, "Real-Time Data Exchange").
/// A note reports the assignment.
/// @param axes  as ReadOptions::axes
void name_robot_log(Contents& contents, int axes);

}  // namespace mbk::recording
