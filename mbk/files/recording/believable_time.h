#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Unwraps a counter that restarted, so that time is continuous: a counter of 16, 24, 31 or 32 bits of any unit
/// of time (signed ones, too), midnight, and an hour set back. Each is reported in a note. Applied only if the step is
/// then one that the clock makes elsewhere; a time that restarts at its first value is another trial and is unchanged.
void unwrap_time(Recording& recording);

/// Applies the rate given by the user if time leaves it open: time counts samples (lost ones remain lost), or its
/// stamps are coarser than the samples and agree with that rate. A note reports it.
/// @return whether it did
[[nodiscard]] bool take_rate(Recording& recording, double rate_hz);

/// Whether a recording of a limb may have this rate and number of samples: above 3 Hz and at most 20 kHz, for less than
/// 12 hours, for less than one hour below 20 Hz, and not as if time were in minutes. Fewer than 20 samples always pass.
[[nodiscard]] bool is_believable(double rate_hz, Index samples);

/// A time without a stated unit, or stated in seconds, must be plausible in seconds (`is_believable`).
/// @param said_by_user  the unit was given with --channels, which is always accepted
/// @fails  data, kUnbelievableTime: it is not; the message gives the duration for milliseconds, microseconds, …, and
/// the option that selects each.
[[nodiscard]] Result<void> check_unit_of_time(const Recording& recording, bool said_by_user);

}  // namespace mbk::recording
