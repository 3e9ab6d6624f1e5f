#pragma once

#include <optional>
#include <set>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/plausible_ranges.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Whether motion, force, clock and model have the size of a limb's (plausible_ranges.h), and whether the axes have the
/// same scale, which the symmetry of the inertia shows. Where they have not, every unit that a channel can have, and
/// powers of ten, are tried in its place; what makes all plausible is named with the --channels that reads it so.
/// A value is checked only if its standard error is below a quarter of it, so that noise causes no warning.
/// @param recordings which the trials were prepared from    @param ignored  ranges that are switched off
[[nodiscard]] std::optional<Warning> check_scale(const std::vector<const Recording*>& recordings,
                                                 const std::vector<PreparedTrial>& trials, const Measurement& measured,
                                                 const std::set<PlausibleQuantity>& ignored);

/// What `check_scale` says of a recording alone, before anything is measured: places, motions and forces that are too
/// large for a limb, and a clock so slow that it lasts for hours. Who stands still or pushes nothing is not accused.
[[nodiscard]] std::optional<Warning> check_size(const Recording& recording, const Inspection& inspection);

/// An error of a recording whose clock runs at no plausible rate, with that said first: time that is read in the wrong
/// unit leaves nothing to measure. Any other error as it is.   @param axes 1, 2, or 0 = by the channels that are there
[[nodiscard]] Error explain_clock(Error error, const Recording& recording, const Inspection& inspection, int axes);

}  // namespace mbk::analyse
