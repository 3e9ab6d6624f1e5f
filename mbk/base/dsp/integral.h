#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::dsp {

/// y[i] = ∫ x dt from the first sample to sample i, by the cubic through the four samples about each interval,
///   ∫_i^{i+1} x dt ≈ T (−x[i−1] + 13 x[i] + 13 x[i+1] − x[i+2])/24,
/// and at both ends by the parabola through three. Exact for a parabola throughout and for a cubic inside; of a sine
/// that is sampled s times in each period the error is (11/720) (2π/s)⁴. Straight lines where there are two samples.
/// @param values evenly sampled    @param sample_time T [s]    @returns the same number of values, the first of them 0
[[nodiscard]] Vector cumulative_integral(const Vector& values, double sample_time);

}  // namespace mbk::dsp
