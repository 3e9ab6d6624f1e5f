#pragma once

#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// Gives the columns of a log that a robot's own program wrote their meaning and unit, where the header shows which
/// program that was. Known are
///   libfranka (franka::logToCSV, and logs with more of franka::RobotState under the same names): time in ms; q[k] is
///   joint k+1, tau_J[k] its torque; O_T_EE[12], O_T_EE[13] are the hand's x and y; O_F_ext_hat_K is what the robot
///   exerts on its environment (franka/robot_state.h), so that the hand's force is its negative.
/// A note says what was taken for what.
void name_robot_log(Contents& contents);

}  // namespace mbk::recording
