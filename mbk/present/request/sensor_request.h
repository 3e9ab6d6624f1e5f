#pragma once

#include <filesystem>
#include <optional>

#include "mbk/base/core/option_table.h"
#include "mbk/base/core/result.h"
#include "mbk/measure/calibration/sensor_force.h"

namespace mbk::request {

/// That voltages become forces by a calibration, and how.
struct SensorRequest {
  std::optional<std::filesystem::path> file;  ///< the calibration; absent: the recording holds forces
  calibration::SensorUse use;                 ///< but for the calibration itself
};

/// --sensor, --lever-arm-mm, --sensor-zero, --sensor-frame and --sensor-delay.
[[nodiscard]] const OptionTable<SensorRequest>& sensor_table();

/// With the calibration, read from its file; nothing where --sensor is not given.
/// @fails  as read_text; data: it is no calibration.
[[nodiscard]] Result<std::optional<calibration::SensorUse>> sensor_use(const SensorRequest& request);

}  // namespace mbk::request
