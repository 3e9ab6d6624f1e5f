#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/words.h"
#include "mbk/measure/calibration/sensor_force.h"

namespace mbk::app {

/// What becomes of the delay that a calibration saw.
enum class SensorDelay { keep, undo };

[[nodiscard]] constexpr auto word_table(SensorDelay) {
  using enum SensorDelay;
  return std::to_array<Word<SensorDelay>>({{keep, "keep"}, {undo, "undo"}});
}

/// What --sensor and the options beside it say, as typed.
struct SensorArguments {
  std::optional<std::filesystem::path> file;
  std::optional<double> lever_arm_mm;
  std::string zero;
  calibration::SensorFrame frame = calibration::SensorFrame::automatic;
  SensorDelay delay = SensorDelay::keep;

  [[nodiscard]] bool operator==(const SensorArguments&) const = default;
};

/// Adds --sensor, --lever-arm-mm, --sensor-zero, --sensor-frame and --sensor-delay.
void add_sensor_options(Command command, SensorArguments& arguments);

/// Adds --sensor-frame alone.
Option add_sensor_frame(Command command, calibration::SensorFrame& frame, const char* description);

/// The calibration file, read, with how it is to be used; nothing where --sensor is not given.
[[nodiscard]] Result<std::optional<calibration::SensorUse>> sensor_use(const SensorArguments& arguments);

}  // namespace mbk::app
