#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/limb_signals.h"
#include "mbk/model/trial/time_course_estimate.h"

namespace mbk::explore {

/// What M, B and K may depend on.
struct CourseVariable {
  std::string name = "time", unit = "s";
  std::vector<Vector> values;  ///< of each trial, one for each of its samples; NaN where the sample does not count
  Index repetitions = 1;       ///< of the range
};

/// M, B, K and c as linear or cubic splines of a variable (varying_regression.h), and whether they change. Rows are
/// those of limb_signals behind a further low-pass, at the lowest rate that passes `band_hz`. Where the reference
/// explains the motion, what it explains is the instrument; least squares otherwise.
///
/// They change where all of this holds: BIC of whitened rows prefers splines to constants, also to constant M, B and K
/// with a varying c (a force that drifts is no change of the limb); the F test of White's covariance that all
/// functions of M, B and K have the same coefficients has a chance below 10⁻⁴, with Bonferroni's bound over the axes;
/// and M, B or K change by a tenth. Otherwise constants are given.
/// @param band_hz  up to which the limb was moved
/// @fails  a variable that never changes; fewer than 20 rows for each coefficient of constants; rows that do not tell
/// M, B and K apart
[[nodiscard]] Result<TimeCourseEstimate> time_course(const LimbSignals& signals, const CourseVariable& variable,
                                                     double band_hz);

}  // namespace mbk::explore
