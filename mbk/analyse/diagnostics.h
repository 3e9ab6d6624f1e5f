#pragma once

#include "mbk/core/result.h"
#include "mbk/trial/diagnostics.h"
#include "mbk/trial/identification.h"
#include "mbk/trial/prepared_trial.h"
#include "mbk/trial/recording.h"

namespace mbk::analyse {

/// What shows how good a measurement is: prediction, residual, spectra, filters, and the recording itself.
/// Numbers (autocorrelation, spectra, agreement) come from every row; series to look at are thinned to two thousand:
/// filtered ones by taking every so many, recorded ones by the extremes of each stretch of samples, so that no spike is
/// lost.
/// @param trial prepared from `recording`; the model may stem from others too (a pooled fit)
/// @param other_acceleration the same trial with ẍ from the other source (sensor or derivative), or nullptr
/// @fails  data: a stretch is too short for a spectrum; the recording lacks the channels of the trial.
[[nodiscard]] Result<Diagnostics> diagnose(const Recording& recording, const PreparedTrial& trial,
                                           const Identification& identification,
                                           const PreparedTrial* other_acceleration);

}  // namespace mbk::analyse
