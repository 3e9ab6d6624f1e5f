#pragma once

#include "mbk/base/core/result.h"
#include "mbk/measure/preprocess/options.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/recording.h"

namespace mbk::preprocess {

/// Recording → ExplorationTrial: channels and the analysed interval, nothing filtered. Of a periodic or random
/// reference the interval is the one in which it is in steady state, as in default_windows(); pulses are explored from
/// the first sample to the last, and so is a recording without a reference. The first 80 % identify.
/// @fails  a channel is missing; time repeats, runs backwards or has a gap inside the interval; a value in it is not
/// finite (channel, sample and time are named); a channel that never changes; fewer than 20 samples.
[[nodiscard]] Result<ExplorationTrial> exploration_trial_of(const Recording& recording, const Inspection& inspection,
                                                            const Options& options);

}  // namespace mbk::preprocess
