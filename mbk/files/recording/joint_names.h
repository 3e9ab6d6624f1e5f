#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/channel_table.h"

namespace mbk::recording {

/// Gives the arrays of a file that names joints (Array::joint) the channels of a robot: the robot's first joint becomes
/// joint_1 and torque_1, and so on. Other joints of the file are no channels.
/// @param joints  names of the robot's joints, in its order; none: nothing is changed
/// @param clock  name of the stream that is meant where several have a joint
/// @returns a note on what was done; "" where nothing was
/// @fails  data: the file lacks a joint (both lists are named), or has one twice.
[[nodiscard]] Result<std::string> match_joints(Contents& contents, std::span<const std::string> joints,
                                               std::string_view clock);

/// Whether a channel that was named joint_k, torque_k, … may be that of the robot's k-th joint.
/// @param named  what the file calls the joint, or else the column
/// @param source  the same for messages
/// @fails  data: `named` names another joint of the robot.
[[nodiscard]] Result<void> check_joint(const ChannelKind& kind, std::span<const std::string> joints,
                                       std::string_view named, const std::string& source);

/// k − 1 of joint_k, torque_k and reference_joint_k.
[[nodiscard]] std::size_t joint_index(const ChannelKind& kind);

/// Whether channels of this kind belong to a joint: joint_k, torque_k, reference_joint_k.
[[nodiscard]] bool is_of_joint(const ChannelKind& kind);

}  // namespace mbk::recording
