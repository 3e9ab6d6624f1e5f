#pragma once

#include <filesystem>
#include <optional>

#include "mbk/core/result.h"
#include "mbk/robot/dynamic_model.h"

namespace mbk::app {

/// The robot that --robot names: what 'mbk robot identify --json' wrote, a description in TOML, or a URDF; without a
/// file the thesis's robot, with the parameters of table A.1.
/// @fails  as reading the file; data: its coefficients are not those of the robot that it describes.
[[nodiscard]] Result<robot::DynamicModel> robot_of(const std::optional<std::filesystem::path>& file);

}  // namespace mbk::app
