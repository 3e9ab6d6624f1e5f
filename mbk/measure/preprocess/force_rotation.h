#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// The recording with its force turned in the plane, F ← R(α) F: undoes a force sensor that is mounted at an angle.
/// @param angle  α [rad], from x to y
/// @fails  usage: not finite; data: no force with two axes.
[[nodiscard]] Result<Recording> turn_force(const Recording& recording, double angle);

}  // namespace mbk::preprocess
