#pragma once

#include <string>

#include "mbk/model/trial/force_summary.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::report {

/// The dynamics of a robot for the terminal: how they were found, every coefficient with its 95 % interval and unit,
/// what could not be identifiable, the fit joint by joint, and warnings with what to try.
[[nodiscard]] std::string robot_text(const RobotIdentification& found);

/// A computed force in short, beside the sensor's where there is one.
[[nodiscard]] std::string force_text(const ForceSummary& force);

}  // namespace mbk::report
