#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"

namespace mbk::dsp {

/// Where the low-pass in front of `decimate` falls to half, as a share of the new Nyquist frequency.
inline constexpr double kDecimationCutoff = 0.8;

/// Rows first, first + every, … of signals that were freed before of what would fold: a Butterworth low-pass of order 8
/// forward and backward, at half at 0.8 of the new Nyquist frequency, 0.027 at that frequency and 0.0015 where folding
/// reaches back to 0.8. The filter is the same for each column, so that a linear relation between them survives.
/// @param signals N×n, evenly sampled    @param every ≥ 1; 1 leaves the signals as they are    @param first in [0, N)
/// @returns ⌈(N − first)/every⌉×n
/// @fails usage: every < 1 or first out of range. As filter_zero_phase: N too short.
[[nodiscard]] Result<Matrix> decimate(const Matrix& signals, Hertz sample_rate, Index every, Index first = 0);

}  // namespace mbk::dsp
