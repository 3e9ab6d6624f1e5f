#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/measure/preprocess/trial_clock.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/robot/mechanism.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// Signals of the joints of a robot in a recording.
struct JointSignals {
  Matrix position;           ///< N×n [rad, or m where a joint slides]
  Matrix torque;             ///< N×n, of the motors [N·m, or N where a joint slides]
  Matrix joint_reference;    ///< N×n; empty if not recorded
  Matrix hand_reference;     ///< N×axes, a position of the hand, base frame [m]; empty if not recorded
  Matrix hand_acceleration;  ///< N×axes, of the accelerometer, base frame [m/s²]; empty unless requested
};

/// joint_1 …, torque_1 … of a recording; a robot of one joint may call it `position`.
/// @fails  data: a channel is missing (named, with the existing ones); its unit does not match the joint.
[[nodiscard]] Result<JointSignals> select_joint_signals(const Recording& recording, const robot::Mechanism& mechanism,
                                                        bool hand_acceleration);

/// Finite inside the cuts, within the limits of the joints, and torques that change. A joint may be beyond its limits
/// by 1 % of its range, at most 0.01 rad: encoders have noise, and stops yield.
/// @param notes  says where a joint was beyond its limits by less than that
/// @fails  data: with channel, sample and time.
[[nodiscard]] Result<void> check_joint_signals(const JointSignals& signals, const robot::Mechanism& mechanism,
                                               const Clock& clock, const WindowPlan& plan,
                                               std::vector<std::string>& notes);

/// Standard deviation of the white noise of each joint's position: by sixth differences, to which a motion of a few
/// hertz gives nothing.
[[nodiscard]] Vector position_noise(const Matrix& position, const std::vector<Cut>& cuts);

/// Which joints stand still: they move by less than twenty steps of their encoder (standard deviation). A step is the
/// smallest change, or √12 times the white noise where that is more: samples that were put on another clock have
/// smaller ones.
[[nodiscard]] std::vector<bool> standing_joints(const JointSignals& signals, const WindowPlan& plan);

/// A cut of them through the smoothing filter alone: row i belongs to sample cut.begin + half window + i.
struct SmoothedJoints {
  robot::JointMotion motion;
  Matrix torque;       ///< that acts, M×n: what was recorded `delay` before
  Matrix torque_rate;  ///< M×n, per second
};

/// @param delay  by which the motors act after the torque that is recorded [s]; between the samples by cubics with the
///               filter's own slopes, beyond the first and last row by straight lines
/// @fails  as savitzky_golay; with an accelerometer, data: a singular configuration, with the time.
[[nodiscard]] Result<SmoothedJoints> smooth_joints(const JointSignals& signals, const robot::Mechanism& mechanism,
                                                   const Cut& cut, const dsp::SavitzkyGolay& smoothing, Hertz rate,
                                                   double delay);

/// Motion only: value and derivatives through the smoothing filter.
[[nodiscard]] Result<robot::JointMotion> smooth_motion(const Eigen::Ref<const Matrix>& position,
                                                       const dsp::SavitzkyGolay& smoothing, Hertz rate);

}  // namespace mbk::preprocess
