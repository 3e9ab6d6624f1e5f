#pragma once

#include <vector>

#include "mbk/base/numeric/independent_columns.h"
#include "mbk/model/robot/dynamic_model.h"

namespace mbk::identify {

/// Base parameters of a robot (Gautier 1991): the coefficients that a motion can identify, and how the others depend on
/// them. Computed from the regressors of fixed random motions, each joint over a full turn or 2 m, so that they depend
/// on the geometry and not on the joint limits. A coefficient is dropped if its column, or the distance of the column
/// from the span of those before, is below 10⁻⁵: a right angle written as 1.5708 in a URDF, an error of 4·10⁻⁶, remains
/// a right angle. Columns are counted among those that are not `fixed`.
[[nodiscard]] numeric::IndependentColumns structural_columns(const robot::DynamicModel& model,
                                                             const std::vector<Index>& fixed = {});

}  // namespace mbk::identify
