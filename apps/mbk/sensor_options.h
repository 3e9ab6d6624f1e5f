#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "mbk/measure/calibration/sensor_force.h"

namespace mbk::app {

/// What --sensor and the options beside it say, as typed.
struct SensorArguments {
  std::optional<std::filesystem::path> file;
  std::optional<double> lever_arm_mm;
  std::string zero, frame = "auto", delay = "keep";
};

/// Adds --sensor, --lever-arm-mm, --sensor-zero, --sensor-frame and --sensor-delay.
void add_sensor_options(CLI::App& command, SensorArguments& arguments);

/// Adds --sensor-frame alone.
CLI::Option* add_sensor_frame(CLI::App& command, std::string& frame, const char* description);

[[nodiscard]] calibration::SensorFrame sensor_frame(const std::string& text);

/// The calibration file, read, with how it is to be used; nothing where --sensor is not given.
[[nodiscard]] Result<std::optional<calibration::SensorUse>> sensor_use(const SensorArguments& arguments);

}  // namespace mbk::app
