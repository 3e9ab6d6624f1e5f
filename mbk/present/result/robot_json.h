#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/independent_columns.h"
#include "mbk/model/robot/drive_terms.h"
#include "mbk/model/robot/robot_description.h"
#include "mbk/model/trial/force_summary.h"
#include "mbk/model/trial/robot_identification.h"

namespace mbk::result {

/// Schema "mbk.robot/1": the dynamics of a robot, with everything that is needed to use them again.
[[nodiscard]] std::string to_json(const RobotIdentification& found);

/// Schema "mbk.force/1": a computed force in short, beside the sensor's where there is one.
[[nodiscard]] std::string to_json(const ForceSummary& force);

/// Schema "mbk.robot_description/1", in SI units and radians: what was understood of a robot's description. A value
/// that the files do not state, and a limit that is not there, is null; a coefficient that no motion tells apart has
/// `part_of`: the coefficients it acts in, with factors.
/// @param base  of the robot's regressors, see identify::structural_columns
[[nodiscard]] std::string to_json(const robot::RobotDescription& description, const numeric::IndependentColumns& base);

/// What a stored robot says, alone: which robot it is stands in its description.
struct StoredRobot {
  std::string description, urdf;  ///< empty for the thesis's robot
  robot::DriveTerms drive;
  std::vector<std::string> names;  ///< of the coefficients
  Vector parameters;
  Matrix covariance;
  double delay = 0;  ///< [s]
  bool usable = true;
  std::vector<std::string> warnings;  ///< their codes
};

/// Reads back what `to_json` wrote.
/// @fails  data: not JSON (the byte is named); another schema; a part is missing or of the wrong shape.
[[nodiscard]] Result<StoredRobot> robot_from_json(std::string_view text);

}  // namespace mbk::result
