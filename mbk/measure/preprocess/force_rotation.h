#pragma once

#include <array>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// Along the axis of a rotation, as long as its angle [rad]. A rotation of the plane, from x to y, is {0, 0, α}.
using RotationVector = std::array<double, 3>;

/// The recording with its force turned, F ← R F: undoes a force sensor that is mounted at an angle.
/// @param rotation  R as a vector (numeric::rotation_matrix)
/// @fails  usage: not finite; data: no force with two axes, or with three if the rotation is not about z.
[[nodiscard]] Result<Recording> turn_force(const Recording& recording, const RotationVector& rotation);

}  // namespace mbk::preprocess
