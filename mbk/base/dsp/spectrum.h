#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"

namespace mbk::dsp {

/// Power spectral density, one-sided.
struct Spectrum {
  Vector frequency;  ///< [Hz], from 0 to rate/2
  Vector density;    ///< [unit²/Hz]; its integral over frequency is the signal's variance
};

/// Welch's estimate (Welch 1967): Hann windows that overlap by half, the mean of each removed.
/// @param signal evenly sampled    @param resolution wanted spacing of lines; the segments are about rate/resolution
/// samples long, shortened to the signal where it is shorter and rounded down to a length made of 2, 3 and 5.
/// @fails fewer than 8 samples; resolution or rate not positive.
[[nodiscard]] Result<Spectrum> welch(const Eigen::Ref<const Vector>& signal, Hertz sample_rate, Hertz resolution);

/// The frequency below which that fraction of the power lies, looking only at lines up to `limit`.
[[nodiscard]] Hertz power_quantile(const Spectrum& spectrum, double fraction, Hertz limit);

/// How many samples a segment has: about rate/resolution, at most `longest` ≥ 8, even, and made of 2, 3 and 5.
[[nodiscard]] Index segment_length(Hertz sample_rate, Hertz resolution, Index longest);

/// ½ − ½ cos(2πi/length), i = 0 … length − 1.
[[nodiscard]] Vector hann_window(Index length);

/// The largest integer ≤ n that is made of the factors 2, 3 and 5 only: lengths at which the transform is fast.
[[nodiscard]] Index fast_length_below(Index n);

/// The smallest even such integer ≥ n.
[[nodiscard]] Index fast_length_above(Index n);

}  // namespace mbk::dsp
