#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/frequency_response_estimate.h"

namespace mbk::explore {

struct WelchOptions {
  double segment_s = 2.0;          ///< [s]; its inverse is the spacing of the lines
  double max_frequency_hz = 50.0;  ///< of the lines that are kept
};

/// Frequency response by averaged spectra (Welch 1967; Bendat & Piersol 2010, ch. 7 and 9),
///   G(f) = S_yr S_ur⁻¹,   cov(vec G) = (S_ur⁻ᵀ S_rrᵀ S_ur⁻*)/n ⊗ S_vv n/(n − n_u),   V = Y − G U
/// with the reference as r where one was recorded, which holds in closed loop too, and else r = u: then G = S_yu
/// S_uu⁻¹, which noise on u biases towards 0 and a limb that answers on its own account towards minus the robot. Hann
/// windows that overlap by half, the mean of each segment removed; n independent ones, of all trials together. Leakage
/// is not corrected: a resonance narrower than two lines is flattened. Multiple coherence is that of cross_spectrum.h;
/// the partial one of y_i and u_j is the coherence of what the other inputs leave of both.
/// @param trials  of the same signals and sample time
/// @fails  no trial; trials of different signals or sample times; none as long as a segment, or too few segments for
/// an interval (n ≤ n_u); usage: a segment of fewer than 8 samples.
[[nodiscard]] Result<FrequencyResponseEstimate> welch_response(std::span<const ExplorationTrial> trials,
                                                               const WelchOptions& options = {});

}  // namespace mbk::explore
