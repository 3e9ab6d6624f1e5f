#pragma once

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// The recording on an even clock, by straight lines between its samples. Only ever done when the user asks.
/// @fails time is not strictly increasing (the first bad sample is named); rate not positive; fewer than 2 samples.
[[nodiscard]] Result<Recording> resample(const Recording& recording, Hertz rate);

}  // namespace mbk::preprocess
