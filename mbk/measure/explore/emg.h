#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/emg_estimate.h"

namespace mbk::explore {

/// The processing at a sample rate: a band that ends at or above the Nyquist frequency ends at 0.9 of it instead.
/// @fails usage: band or envelope are not positive, or low ≥ high; both a low-pass and an RMS window. data: a rate
/// below 300 Hz, from which no EMG follows (SENIAM asks for 1000 Hz and more), or a band that is empty at this rate.
[[nodiscard]] Result<EmgProcessing> emg_processing_at(Hertz rate, const EmgProcessing& wanted);

/// Raw EMG → band: Butterworth high-pass and low-pass, each of order/2 forward and backward. `order` is that of both
/// passes together, as in "fourth-order zero-lag"; the cut-offs of each pass are moved by (√2 − 1)^(1/order) so that
/// both passes together attenuate by 3 dB at the ends of the band (Winter 2009, Biomechanics and Motor Control of
/// Human Movement, §3.4.4). 20 Hz and 12 dB/octave or more at the low end: De Luca, Gilmore, Kuznetsov & Roy 2010, J
/// Biomech 43:1573; 400 to 500 Hz at the high end: SENIAM (Hermens, Freriks, Disselhorst-Klug & Rau 2000, J
/// Electromyogr Kinesiol 10:361), ISEK (Merletti 1999).
/// @param raw [V], N
/// @fails order not even; as emg_processing_at and dsp::filter_zero_phase
[[nodiscard]] Result<Vector> emg_band(const Vector& raw, const EmgProcessing& how);

/// Rectified EMG → envelope: zero-phase low-pass as above, of order 4 in both passes together, or the root of the mean
/// square over a centred window, which is cut at the ends.
/// @fails as emg_band
[[nodiscard]] Result<Vector> emg_envelope(const Vector& rectified, const EmgProcessing& how);

/// Sums of the first 0, 1 … N values, N + 1.
[[nodiscard]] Vector running_sums(const Vector& values);

/// What is wrong with one raw channel:
///  - not finite: a sample is NaN or infinite; unusable.
///  - constant, few levels: fewer than 2 or 32 different values; unusable.
///  - rectified: no sample is negative, and the skewness is above 0.5; unusable.
///  - clipping: two or more runs of at least three samples at the largest or the smallest value.
///  - mains hum: more than 5 % of the power in the band is at 50 or 60 Hz and its harmonics, above the median of the
///    neighbours between 3 and 8 Hz away.
///  - movement artefact: more power between 1 and 20 Hz than in the band; of 100 times more, unusable.
/// Messages give value and limit.   @param how  as emg_processing_at gives it
[[nodiscard]] std::vector<EmgFinding> check_emg(const Vector& raw, const EmgProcessing& how);

/// Whether a channel is weak: of at least three channels, its root mean square in the band is below a tenth of the
/// median. NaN counts as no channel.
/// @param rms  of each channel [V]
[[nodiscard]] std::vector<bool> weak_channels(const std::vector<double>& rms);

}  // namespace mbk::explore
