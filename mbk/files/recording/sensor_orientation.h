#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Turns the force of a sensor that moves with the hand into the frame of the position: F_base = R(q) F, where q is the
/// unit quaternion in the channels sensor_qx, sensor_qy, sensor_qz and sensor_qw, the orientation of the sensor in that
/// frame. These channels are then removed, and a note says so. Without them nothing is done.
/// @fails  data: one of the four, or of force_x, force_y and force_z, is missing; a quaternion is not of length 1.
[[nodiscard]] Result<void> turn_force_to_base(Recording& recording);

}  // namespace mbk::recording
