#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/diagnostics.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Quality of a measurement: prediction, residual, spectra, filters, and the recording itself.
/// Numbers (autocorrelation, spectra, agreement) use every row of the trial; only drawn data are decimated
/// (decimation.h). The prediction is from the model that was not fitted to the held-out data, so it corresponds to the
/// VAF; the analysed residual is that of the reported model.
/// @param recording  the source of the trial, after resampling if that was requested
/// @param identification  may also be from other trials (a pooled fit)
/// @param other_acceleration the same trial with ẍ from the other source (sensor or derivative), or nullptr
/// @fails  data: the recording is not the source of the trial (a channel or samples are missing); the trial has no
/// rows.
[[nodiscard]] Result<Diagnostics> diagnose(const Recording& recording, const PreparedTrial& trial,
                                           const Identification& identification,
                                           const PreparedTrial* other_acceleration);

}  // namespace mbk::analyse
