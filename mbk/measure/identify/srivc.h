#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::identify {

struct ContinuousFitOptions {
  Index poles = 2, zeros = 0;          ///< n ≥ 1 and 0 ≤ m ≤ n
  std::vector<double> start_poles;     ///< [rad/s] of the first filter; empty: several over the band of the samples
  bool only_given_starts = false;      ///< otherwise those over the band are tried, too
  bool free_start = true;              ///< an initial state and an offset of the output for each experiment
  Index max_noise_order = 0;           ///< RIVC: autoregressive noise model up to this order, by BIC; 0: SRIVC
  bool reference_instruments = false;  ///< closed loop: instruments from the reference alone
  double hac_lag_s = 0.0;              ///< noise correlation time in the covariance [s]; 0: white
  double tolerance = 1e-4;             ///< largest relative change of a coefficient at convergence
  int max_iterations = 100;
  bool refine = true;        ///< continue to rounding precision after convergence
  bool delay_found = false;  ///< from the same data: it is one more parameter of the covariance; fewer zeros than poles
  unsigned threads = 0;      ///< for the starts; 0: number of cores
};

/// Result of a search, from the best start that converged to a stable model, or from the best one if none did.
struct ContinuousFit {
  Vector a, b;             ///< a₀ … a_{n−1} and b₀ … b_m, physical time
  bool converged = false;  ///< converged, and the solution is stable
  bool stable = true;
  Matrix covariance;                     ///< of [a; b]
  std::optional<double> delay_variance;  ///< [s²] if the delay is a parameter
  double delay_correction = 0;           ///< by which one Gauss–Newton step would move that delay [s]
  Matrix white_covariance;               ///< the same assuming a white residual
  double variance = 0;                   ///< of the residual (with a noise model: of its innovations)
  double fit = 0;                        ///< R_T² = 1 − Σe²/Σ(y − ȳ)²
  Vector noise;                          ///< 1, c₁ … of the noise model; [1] without one
  std::vector<Vector> residuals;         ///< y − x̂ of each experiment
  std::vector<SearchStart> starts;
  Index samples = 0;
};

/// Simplified refined instrumental variables for continuous-time models (Young & Jakeman 1980; Garnier & Young 2008):
///   y = B(s)/A(s) u + C(s)/A(s) δ + c + e,
/// fitted to sampled signals without any difference quotient. The signals and the model's own noise-free output x̂ are
/// filtered by sᵏ/A(s) exactly for the hold of the experiment (dsp::DerivativeFilter; y and x̂ run in straight lines);
/// X = [−y_f, u_f], Z = [−x̂_f, u_f] and
///   θ ← θ + (ZᵀX)⁻¹ Zᵀ(y − x̂),
/// with A of the last pass, whose roots are reflected into the left half plane, until no coefficient changes by more
/// than the tolerance. The fixed point is a stationary point of Σe² (output error). C and c, an initial state and an
/// offset, are projected out for each experiment. Time is scaled by the geometric mean of the poles.
///   First pass: least squares on filters (s + λ)⁻ⁿ, for several λ, as one alone can end in a local minimum.
///   A λ that determines nothing is doubled.
///   RIVC: X, Z and e also pass an autoregressive model of e, re-estimated until both converge.
///   Closed loop: Z = [−x̂_f, û_f], where û is the response of a finite impulse response to the reference. It starts
///   with û for u, and uses the start whose model gives the smallest residual of y from û.
/// @param experiments  each [1 … N] samples; their clocks may be uneven, but not with a noise model or closed loop
/// @fails  usage: orders out of range; no experiment; a noise model or closed loop on an uneven clock; no reference.
///         data: too few samples; a value is not finite; input or output is constant.
[[nodiscard]] Result<ContinuousFit> fit_continuous(const std::vector<SignalPair>& experiments,
                                                   const ContinuousFitOptions& options);

/// As fit_continuous looks at experiments and options before it begins.
/// @fails  as it does
[[nodiscard]] Result<void> check_experiments(const std::vector<SignalPair>& experiments,
                                             const ContinuousFitOptions& options);

/// Response of a continuous-time model from rest to the experiment's input (without its delay), exactly for its hold.
/// @param a a₀ … a_{n−1}    @param b b₀ … b_m    @returns as many values as there are samples
[[nodiscard]] Vector simulate_continuous(const Vector& a, const Vector& b, const SignalPair& experiment);

/// What the best initial state and offset leave of `residual`, and so does the simulation's error of a record that did
/// not begin at rest.
[[nodiscard]] Vector without_free_motion(const Vector& a, const SignalPair& experiment, const Vector& residual);

}  // namespace mbk::identify
