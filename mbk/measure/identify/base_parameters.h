#pragma once

#include <vector>

#include "mbk/base/numeric/independent_columns.h"
#include "mbk/model/robot/dynamic_model.h"

namespace mbk::identify {

/// A robot's base parameters (Gautier 1991): which of its coefficients some motion could identify, and what the others
/// are made of. From the regressors of motions that are random and always the same ones, each joint over a whole turn
/// or 2 m, so that the count is that of the robot's geometry and not of its limits. A coefficient whose column, or its
/// distance from the span of those before, is below 10⁻⁵ does not count: a right angle that a URDF states as 1.5708
/// is 4·10⁻⁶ away from one, and is one. Columns are counted among those that are not `fixed`.
[[nodiscard]] numeric::IndependentColumns structural_columns(const robot::DynamicModel& model,
                                                             const std::vector<Index>& fixed = {});

}  // namespace mbk::identify
