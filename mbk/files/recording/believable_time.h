#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Adds what a counter lost where it began anew, so that time runs on: a counter of 16, 24, 31 or 32 bits of any unit
/// of time (signed ones, too), midnight, and an hour set back. Each is a note. Only where the step across it is then
/// one that the clock makes elsewhere; a time that begins again at its first value is another trial, and stays.
void unwrap_time(Recording& recording);

/// Gives time the rate that the user said, where it leaves that open: it counts samples (lost ones remain lost), or its
/// stamps are coarser than the samples and keep to that rate. A note says so.
/// @return whether it did
[[nodiscard]] bool take_rate(Recording& recording, double rate_hz);

/// Whether so many samples of a limb may have been recorded at that rate: above 3 Hz and at most 20 kHz, for less
/// than 12 hours, for less than one hour below 20 Hz, and not as if minutes had been told in minutes. Fewer than 20
/// samples, of which nothing can be computed, are left alone.
[[nodiscard]] bool is_believable(double rate_hz, Index samples);

/// A time whose unit nobody said, or whose file says seconds, must run as time in seconds can (`is_believable`).
/// @param said_by_user  the unit was given with --channels: then whatever it is is believed
/// @fails  data, kUnbelievableTime: it does not; the message says what the time would be in milliseconds, microseconds,
/// …, and how to say so.
[[nodiscard]] Result<void> check_unit_of_time(const Recording& recording, bool said_by_user);

}  // namespace mbk::recording
