#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::recording {

/// Assigns the arrays of a file that names joints (Array::joint) to the channels of a robot: the robot's first joint
/// becomes joint_1 and torque_1, and so on. Other joints of the file do not become channels.
/// @param joints  names of the robot's joints, in its order; none: nothing is changed
/// @param clock  name of the stream to use if several have a joint
/// @returns a note on the assignment; "" if there was none
/// @fails  data: the file lacks a joint (the message gives both lists), or has one twice.
[[nodiscard]] Result<std::string> match_joints(Contents& contents, std::span<const std::string> joints,
                                               std::string_view clock);

/// Whether a channel that was named joint_k, torque_k, … may be that of the robot's k-th joint.
/// @param named  name of the joint in the file, or else of the column
/// @param source  the same for messages
/// @fails  data: `named` names another joint of the robot.
[[nodiscard]] Result<void> check_joint(const ChannelKind& kind, std::span<const std::string> joints,
                                       std::string_view named, const std::string& source);

/// k − 1 of joint_k, torque_k and reference_joint_k.
[[nodiscard]] std::size_t joint_index(const ChannelKind& kind);

/// Whether channels of this kind belong to a joint: joint_k, torque_k, reference_joint_k.
[[nodiscard]] bool is_of_joint(const ChannelKind& kind);

}  // namespace mbk::recording
