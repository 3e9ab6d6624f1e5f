#pragma once

#include <set>
#include <vector>

#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/plausible_ranges.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Adds to a measurement what shows that its recording was read wrongly: the same column twice, a column that its file
/// calls otherwise, a scale that no limb has (plausible_scale.h), signs or axes of force and motion that do not belong
/// together (axis_maps.h), a handle heavier than what was measured. Each but the second makes it
/// unusable. Warnings that only follow from such a cause go, and the last version's code stays as `was`.
/// Where there is no such cause, each warning's advice is turned to what the measurement itself shows to help.
/// @param recordings which the trials were prepared from    @param ignored  ranges that are switched off
void judge_plausibility(const std::vector<const Recording*>& recordings, const std::vector<PreparedTrial>& trials,
                        const std::set<PlausibleQuantity>& ignored, Measurement& measured);

}  // namespace mbk::analyse
