#pragma once

#include <string>

#include "mbk/base/numeric/independent_columns.h"
#include "mbk/model/robot/robot_description.h"

namespace mbk::result {

/// Schema "mbk.robot_description/1", in SI units and radians: what was understood of a robot's description. A value
/// that the files do not state, and a limit that is not there, is null; a coefficient that no motion tells apart has
/// `part_of`: the coefficients it acts in, with factors.
/// @param base  of the robot's regressors, see identify::structural_columns
[[nodiscard]] std::string to_json(const robot::RobotDescription& description, const numeric::IndependentColumns& base);

}  // namespace mbk::result
