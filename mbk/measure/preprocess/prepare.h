#pragma once

#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/measure/preprocess/virtual_force.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// Recording → PreparedTrial: channels, windows, smoothing and derivatives, low-pass. Both modes pass through here;
/// they differ in the windows, in their order with the filter, and in where the settings come from.
/// Motion and force pass through the same linear filters, so that −F = M ẍ + B ẋ + K(x − x₀) survives them.
/// @param computed  where `recording` is what virtual_force made: its uncertainty is filtered along
/// @fails a channel is missing; time repeats, runs backwards or has a gap inside the window; a value in the window is
/// not finite (file, channel, sample and time are named); a window is shorter than the filters need.
[[nodiscard]] Result<PreparedTrial> prepare(const Recording& recording, const Inspection& inspection,
                                            const Options& options, const VirtualForce* computed = nullptr);

}  // namespace mbk::preprocess
