#pragma once

#include <optional>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/analyse/movement_quality.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/trial/movement.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

struct MovementQualityOptions {
  int axes = 0;  ///< 1, 2, or 0 = by the channels that are there
  preprocess::WindowLimits window;
  std::optional<Hertz> resample;  ///< put the samples on an even clock first
  analyse::MovementOptions movement;
};

/// Reaches of one recording and their quality: the hand's position, and, where they were recorded and are finite, the
/// force of the hand and the reference as its target.
/// @fails  no position; time that is not even within the limits (a clock that only jitters is put on an even one); a
/// position that is not finite; as analyse::movement_quality
[[nodiscard]] Result<MovementQuality> movement_quality(const Recording& recording,
                                                       const MovementQualityOptions& options);

}  // namespace mbk::measurement
