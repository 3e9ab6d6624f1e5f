#pragma once

#include <Eigen/Core>
#include <vector>

#include "mbk/core/linear_algebra.h"
#include "mbk/core/result.h"
#include "mbk/core/units.h"

namespace mbk::dsp {

/// Spectral densities of several signals and of each with each other, one-sided.
struct CrossSpectra {
  Vector frequency;                       ///< [Hz], from 0 to rate/2
  std::vector<Eigen::MatrixXcd> density;  ///< S at each frequency, n×n, Hermitian: S_jk = E[X_j X_k*] [unit²/Hz]
  Index segments = 0;                     ///< that were averaged
  double independent_segments = 0;        ///< as many that do not overlap would vary as much
};

/// Welch's estimate as in spectrum.h, averaged over pieces of a recording; no segment reaches across a break.
/// Hann windows that overlap by half share 1/36 of their variance with a neighbour (Harris 1978, table I), so that K of
/// them are worth K/(1 + 2/36 (1 − 1/K)) independent ones (Welch 1967, eq. 12).
/// @param pieces N_i×n, evenly sampled    @param resolution wanted spacing of lines; segments are as long as the
/// shortest piece allows at most
/// @fails no piece; a piece of fewer than 8 samples or another number of signals; rate or resolution not positive.
[[nodiscard]] Result<CrossSpectra> cross_spectra(const std::vector<Matrix>& pieces, Hertz sample_rate,
                                                 Hertz resolution);

/// Multiple coherence of each output with all inputs together, γ² = S_yx S_xx⁻¹ S_xy/S_yy in [0, 1]: the share of the
/// output's power that linear responses to the inputs can explain (Bendat & Piersol 2010, eq. 7.35). With as many
/// segments as inputs or fewer it is 1 whatever the signals are.
/// @param inputs the first so many signals are inputs, the others outputs
/// @returns lines×outputs; NaN where the inputs cannot be told apart or the output has no power.
[[nodiscard]] Matrix multiple_coherence(const CrossSpectra& spectra, Index inputs);

/// The coherence that signals without any relation stay below in 95 % of cases. For n independent segments and q
/// inputs γ² is then Beta(q, n − q) distributed, so that P(γ² > c) = Σ_{k<q} C(n − 1, k) c^k (1 − c)^{n−1−k}
/// (Goodman 1963; n need not be whole).
/// @returns 1 where n ≤ q
[[nodiscard]] double significant_coherence(double independent_segments, Index inputs);

/// Autocorrelation r[l] = Σ_t e_t e_{t+l}/Σ_t e_t² over pieces, biased towards zero by the missing pairs; products
/// never cross a break. The mean is not taken off.
/// @param pieces of one signal    @param lags which, in samples, each ≥ 0    @returns NaN throughout for a zero signal
[[nodiscard]] Vector autocorrelation(const std::vector<Vector>& pieces, const std::vector<Index>& lags);

}  // namespace mbk::dsp
