#pragma once

#include <optional>
#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/exploration_trial.h"
#include "mbk/model/trial/frequency_response_estimate.h"

namespace mbk::explore {

struct PeriodicOptions {
  std::optional<double> period_s;  ///< absent: found in the reference or, without one, in the input
  double max_frequency_hz = 50.0;
  bool without_realisations = false;  ///< the fast method, also where realisations show the distortion
};

/// Frequency response at the lines of a periodic perturbation, from P periods of each of M realisations (Pintelon &
/// Schoukens 2012, ch. 4; Schoukens, Vaes & Pintelon 2016). With U_m, Y_m the means over the periods and R_m the
/// reference of realisation m (without one U_m),
///   G = (Σ Y_m R_mᴴ) A⁻¹,   A = Σ U_m R_mᴴ
/// which is projected on the reference: right in closed loop, where a mean of ratios Y_m/U_m is not, and exact for
/// orthogonal references of two axes. Variances:
///   noise   Σ_m |R_mᴴ A⁻¹|² ⊗ C_m/P_m,   C_m the covariance of Y − G U from period to period
///   total   N/(N − q) Σ_g e_g e_gᴴ,   e_g = vec(Σ_{m∈g} (Y_m − G U_m) R_mᴴ A⁻¹)
/// over N groups g: n_u experiments with orthogonal references (q = 1), or one (q = n_u). Total beyond noise is
/// stochastic nonlinear distortion. Where there are too few realisations the covariance is that of noise, with the
/// distortion at empty odd lines added where there are such (the fast method).
/// At empty lines between the excited ones the output has its even and odd distortion, once G U is subtracted that the
/// input carries there, with G between lines by straight lines.
/// A realisation is a segment of the reference that repeats itself, of any of the trials; those that are the same but
/// for a shift in time are one. The first period of each is left out where it differs from the others (F test, 0.1 %).
/// @param trials  of the same signals and sample time
/// @fails  data: no period is found, or fewer than two fit; fewer realisations than inputs; no line at which the
/// inputs are excited in all directions; usage: a period of less than 8 samples.
[[nodiscard]] Result<FrequencyResponseEstimate> periodic_response(std::span<const ExplorationTrial> trials,
                                                                  const PeriodicOptions& options = {});

}  // namespace mbk::explore
