#pragma once

#include <filesystem>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/model/robot/robot_description.h"

namespace mbk::robot_file {

/// A robot from a TOML file, docs/guide/own_robot.md lists its keys:
///   [robot] kind = "planar" | "one_axis" | "urdf", and the keys of that kind;  [drive] terms, values, motor_delay_ms
/// A section [device] is not looked at.
/// A file named .urdf is read as the whole robot, from its root to its only leaf.
/// @fails  data: a file cannot be read, or is larger than 1 MB (TOML) or 10 MB (URDF); what Document::finish() and
/// robot::SerialChain::from_urdf say.
[[nodiscard]] Result<robot::RobotDescription> read_robot_description(const std::filesystem::path& file);

/// The same of texts that stand somewhere else, such as in a result.
/// @param urdf   the text of the file that `toml` names; not looked at unless kind = "urdf"
/// @param where  how messages call it
[[nodiscard]] Result<robot::RobotDescription> parse_robot_description(std::string_view toml, std::string_view urdf,
                                                                      std::string_view where);

/// The robot of the thesis with the coefficients of table A.1 (Dyck 2013), moving in a horizontal plane.
[[nodiscard]] robot::RobotDescription thesis_robot();

}  // namespace mbk::robot_file
