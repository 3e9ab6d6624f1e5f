#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// What shows how good a measurement is: prediction, residual, spectra, filters, and the recording itself.
/// Numbers (autocorrelation, spectra, agreement) come from every row of the trial; only what is drawn is decimated
/// (decimation.h). The prediction is that of the model which did not see the held-out data, so that it is what the VAF
/// says; the residual that is analysed is that of the reported model.
/// @param recording which the trial was prepared from: put on an even clock first where that was asked
/// @param identification may stem from other trials too (a pooled fit)
/// @param other_acceleration the same trial with ẍ from the other source (sensor or derivative), or nullptr
/// @fails  data: the recording is not the one of the trial: a channel is missing, or samples are; no row of the trial
/// counts.
[[nodiscard]] Result<Diagnostics> diagnose(const Recording& recording, const PreparedTrial& trial,
                                           const Identification& identification,
                                           const PreparedTrial* other_acceleration);

}  // namespace mbk::analyse
