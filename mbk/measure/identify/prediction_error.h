#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::identify {

struct PredictionErrorOptions {
  Index poles = 2, zeros = 1;       ///< n ≥ 1 and 0 ≤ m ≤ n
  std::vector<double> start_poles;  ///< [rad/s], tried beside the starts that the method makes by itself
  Vector start_denominator;         ///< f₁ … f_n of the only start; empty: those above
  bool free_start = true;           ///< an initial state and an offset of the output for each experiment
  bool noise_model = false;         ///< Box–Jenkins; otherwise output error
  Index max_noise_order = 8;        ///< of the noise model
  double hac_lag_s = 0.0;           ///< correlation time of the innovations in the covariance [s]; 0: white
  double tolerance = 1e-4;          ///< of a coefficient or of its standard error, by which the last step moves it
  int max_iterations = 200;
  unsigned threads = 0;  ///< for the starts; 0: number of cores
};

/// Result of a search, from the best start that converged to a stable model, or from the best one if none did.
struct PredictionErrorFit {
  Vector f, b;              ///< f₁ … f_n and b₀ … b_m
  bool converged = false;   ///< converged inside the region of stable models
  bool stable = true;       ///< false if the search leaves it
  Matrix covariance;        ///< of [f; b]
  Matrix white_covariance;  ///< the same as if the innovations were white
  double variance = 0;      ///< of the innovations
  double fit = 0;           ///< R_T² = 1 − Σ(y − x̂)²/Σ(y − ȳ)²
  Vector noise_denominator = Vector::Ones(1), noise_numerator = Vector::Ones(1);  ///< C and D
  std::vector<Vector> residuals, innovations;  ///< y − x̂ and ε of each experiment
  std::vector<SearchStart> starts;
  Index samples = 0;
};

/// Prediction-error estimate of a discrete-time model (Ljung 1999, §7 and §10.2):
///   y = B(q⁻¹)/F(q⁻¹) u + P(q⁻¹)/F(q⁻¹) δ + c + D(q⁻¹)/C(q⁻¹) ε,    min Σε²
/// with C = D = 1 for output error. Levenberg–Marquardt on exact derivatives, which are signals through filters:
///   ∂ε/∂b_k = −C/(D F) u[t − k],   ∂ε/∂f_k = C/(D F) x̂[t − k],   ∂ε/∂c_k = v[t − k]/D,   ∂ε/∂d_k = −ε[t − k]/D
/// with v = y − x̂. The initial state P and the offset c of each experiment are linear, and projected out (Golub &
/// Pereyra 1973). Steps to unstable models are rejected; a search blocked there has not converged, and its start is
/// tried again without refinement, then with the blocked poles moved away from the unit circle.
///   Starts, as one alone can end in a local minimum: the continuous-time model of fit_continuous, z = e^{pT}; an ARX
/// model of high order reduced; an ARX model; instrumental variables from it; real poles over the band, and those
/// given. Each is refined by the iteration of Steiglitz & McBride (1965), and the numerator is always the best for
/// its poles.
///   Box–Jenkins: the dynamics first behind the noise model of the high-order ARX model, which is held, and those of
/// output error; then as many c as d, or c alone, as the BIC of what is left says, then all at once; a noise model that
/// does not settle gives way to the one of next BIC.
/// @param experiments  each on the same even clock, with its delay taken out of the input
/// @fails  usage: orders out of range; no experiment; an uneven clock; clocks that differ; a start of another order or
///         with a value that is not finite.
///         data: too few samples; a value is not finite; input or output is constant.
[[nodiscard]] Result<PredictionErrorFit> fit_prediction_error(const std::vector<SignalPair>& experiments,
                                                              const PredictionErrorOptions& options);

/// The common sample interval [s]; 0 without experiments.
/// @fails usage: a clock is not uniform, or two differ.
[[nodiscard]] Result<double> common_step(const std::vector<SignalPair>& experiments,
                                         const std::vector<SignalPair>& held_out = {});

/// `residual`, the error of a simulation from rest, after removing the best initial state and offset.
/// @param f f₁ … f_n
[[nodiscard]] Vector without_discrete_free_motion(const Vector& f, const Vector& residual);

}  // namespace mbk::identify
