#pragma once

#include <string>

#include "mbk/model/trial/sensor_calibration.h"

namespace mbk::report {

/// The calibration of a force sensor for the terminal: slopes and zeros with standard errors, crosstalk, linearity,
/// noise and resolution, warnings, and the options that apply it.
[[nodiscard]] std::string sensor_text(const SensorCalibration& calibration);

}  // namespace mbk::report
