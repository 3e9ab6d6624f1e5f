#pragma once

#include <string>
#include <string_view>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/measured_delay.h"
#include "mbk/model/trial/sensor_calibration.h"

namespace mbk::result {

/// Schema "mbk.sensor/1": the calibration of a force sensor, SI units.
[[nodiscard]] std::string to_json(const SensorCalibration& calibration);

/// Schema "mbk.sensor_delay/1".
[[nodiscard]] std::string to_json(const MeasuredDelay& found);

/// Reads back what `to_json` wrote.
/// @fails  not JSON (the byte is named); another schema; axes that are not x and y; a matrix of the wrong shape, or a
///         slope or zero that is not finite (its name is reported); slopes that cannot be inverted.
[[nodiscard]] Result<SensorCalibration> sensor_calibration_from_json(std::string_view text);

}  // namespace mbk::result
