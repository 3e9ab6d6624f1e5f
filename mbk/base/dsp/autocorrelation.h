#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::dsp {

/// Autocorrelation r[l] = Σ_t e_t e_{t+l}/Σ_t e_t², l = 0 … last, over pieces of one signal, by the Fourier transform
/// of pieces continued by `last` zeros. Products never cross a break. The mean is not removed.
///
/// Biased: both sums run over what there is, so that a lag of l samples loses l pairs of every piece and r shrinks
/// towards zero, in one piece of N samples by 1 − l/N. In return r is a positive semidefinite sequence and its spread
/// does not grow with the lag (Box, Jenkins & Reinsel 2008, §2.1.5).
/// @param last ≥ 0    @returns last + 1 values, the first of them 1; NaN throughout where the signal is zero or missing
[[nodiscard]] Vector autocorrelation(const std::vector<Vector>& pieces, Index last);

}  // namespace mbk::dsp
