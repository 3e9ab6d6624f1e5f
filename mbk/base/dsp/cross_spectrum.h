#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"

namespace mbk::dsp {

/// Spectral densities of several signals and of each with each other, one-sided.
struct CrossSpectra {
  Vector frequency;                       ///< [Hz], from 0 to rate/2 or less
  std::vector<Eigen::MatrixXcd> density;  ///< S at each frequency, n×n, Hermitian: S_jk = E[X_j X_k*] [unit²/Hz]
  Index segments = 0;                     ///< that were averaged
  double independent_segments = 0;        ///< number of non-overlapping segments with the same variance
};

/// Welch's estimate as in spectrum.h, averaged over pieces of a recording; no segment reaches across a break, and a
/// piece shorter than a segment does not count.
/// Two Hann windows that overlap by half are correlated by 1/6 (Harris 1978, table I), so that K segments of which P
/// overlap their predecessor vary as much as K/(1 + 2/36 P/K) independent ones (Welch 1967).
/// @param pieces N_i×n, evenly sampled    @param segment samples of a segment, even, ≥ 8; rate/segment is the spacing
/// of the lines. The transform is fast where it is made of small factors.
/// @param highest lines above it are left out; there are two at least
/// @fails no piece is as long as a segment; pieces of different numbers of signals; segment odd or below 8; rate not
/// positive.
[[nodiscard]] Result<CrossSpectra> cross_spectra(const std::vector<Matrix>& pieces, Hertz sample_rate, Index segment,
                                                 Hertz highest = Hertz(std::numeric_limits<double>::infinity()));

/// Multiple coherence of each output with all inputs together, γ² = S_yx S_xx⁻¹ S_xy/S_yy in [0, 1]: the share of the
/// output's power that linear responses to the inputs can explain (Bendat & Piersol 2010, ch. 7); of one input it is
/// the ordinary coherence. With as many segments as inputs or fewer it is 1 whatever the signals are.
/// @param inputs number of inputs, which come before the outputs
/// @returns lines×outputs; NaN where the inputs cannot be distinguished (whatever their units: judged by the coherence
/// between them) or where a signal has no power.
[[nodiscard]] Matrix multiple_coherence(const CrossSpectra& spectra, Index inputs);

/// The coherence that signals without any relation stay below in 95 % of cases. For n independent segments and q
/// inputs γ² is then Beta(q, n − q) distributed, so that P(γ² > c) = Σ_{k<q} C(n − 1, k) c^k (1 − c)^{n−1−k}
/// (Goodman 1963; n need not be whole).
/// @returns 1 where n ≤ q
[[nodiscard]] double significant_coherence(double independent_segments, Index inputs);

}  // namespace mbk::dsp
