#pragma once

#include <filesystem>
#include <optional>

#include "mbk/base/core/result.h"
#include "mbk/model/robot/robot_description.h"

namespace mbk::request {

/// The robot that --robot names: a description in TOML, a URDF, or what 'mbk robot identify --json' wrote; without a
/// file the thesis's robot, with the parameters of table A.1.
/// @fails  as reading the file; data: its coefficients are not those of the robot that it describes.
[[nodiscard]] Result<robot::RobotDescription> describe_robot(const std::optional<std::filesystem::path>& file);

/// The same, to compute a force with: every coefficient must be known.
/// @fails  as describe_robot; data: the file leaves coefficients open (they are named); not usable: 'mbk robot
/// identify' found them and said that they must not be used.
[[nodiscard]] Result<robot::DynamicModel> robot_of(const std::optional<std::filesystem::path>& file);

}  // namespace mbk::request
