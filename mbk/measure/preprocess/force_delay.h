#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// The recording with a force that was read late put where it belongs: F(t) is what was read at t + τ, by straight
/// lines between samples. What was not read yet at the end is cut off.
/// @param delay  τ [s], also below 0
/// @fails  usage: not finite, or as long as the recording; data: no force, or time does not increase.
[[nodiscard]] Result<Recording> undo_force_delay(const Recording& recording, double delay);

}  // namespace mbk::preprocess
