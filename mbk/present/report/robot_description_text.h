#pragma once

#include <string>

#include "mbk/base/numeric/independent_columns.h"
#include "mbk/model/robot/robot_description.h"

namespace mbk::report {

/// What was understood of a robot's description, for the terminal: joints and limits, where the hand is with every
/// joint at zero, the terms of the drives, every coefficient with its value, and what any motion could identify.
/// @param base  of the robot's regressors, see identify::structural_columns
[[nodiscard]] std::string robot_description_text(const robot::RobotDescription& description,
                                                 const numeric::IndependentColumns& base);

}  // namespace mbk::report
