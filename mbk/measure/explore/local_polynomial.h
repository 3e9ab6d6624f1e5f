#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/frequency_response_estimate.h"

namespace mbk::explore {

struct LocalPolynomialOptions {
  double bandwidth_hz = 0.5;  ///< of the lines behind one estimate; widened where they are too few
  double max_frequency_hz = 50.0;
};

/// Frequency response to any perturbation by the local polynomial method of order 2 (Schoukens, Vandersteen, Barbé &
/// Pintelon 2009; Pintelon & Schoukens 2012, ch. 7). Around line k of the whole record, r = −R … R,
///   Z(k + r) = (G + g₁ r + g₂ r²) X(k + r) + T + t₁ r + t₂ r² + V
/// with a polynomial T for each trial, which takes the transients and leakage of its ends. X is the input and Z the
/// output; with a reference X is that and Z = [y; u], from which the response is G_yr G_ur⁻¹, in closed loop too. The
/// covariance of V from 2R + 1 − 3 (n_u + 1) degrees of freedom, of one trial, gives that of G. Estimates stand half a
/// bandwidth apart. Coherence is the share of y that the local response to X explains, beyond what it would of
/// noise alone: in a closed loop noise that moves both u and y is not part of it.
/// @param trials  of the same signals and sample time; the longer are cut to the shortest
/// @fails  data: too few samples for so many unknowns; the input leaves too many lines empty to tell its response from
/// a transient, as a periodic one does; usage: a bandwidth or frequency that is not above 0.
[[nodiscard]] Result<FrequencyResponseEstimate> local_polynomial_response(std::span<const ExplorationTrial> trials,
                                                                          const LocalPolynomialOptions& options = {});

}  // namespace mbk::explore
