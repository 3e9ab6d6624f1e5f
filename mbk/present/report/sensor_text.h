#pragma once

#include <string>

#include "mbk/model/trial/measured_delay.h"
#include "mbk/model/trial/sensor_calibration.h"

namespace mbk::report {

/// The calibration of a force sensor for the terminal: slopes and zeros with standard errors, crosstalk, linearity,
/// noise and resolution, warnings, and the options that apply it.
[[nodiscard]] std::string sensor_text(const SensorCalibration& calibration);

/// The delay of a force sensor with its interval, and the option that corrects it; or why it is not usable.
[[nodiscard]] std::string sensor_delay_text(const MeasuredDelay& found);

}  // namespace mbk::report
