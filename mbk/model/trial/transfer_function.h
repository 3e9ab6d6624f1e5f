#pragma once

#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// An input and the output that it causes, sample by sample, without a break.
struct SignalPair {
  Vector time;                 ///< [s], strictly increasing
  Vector input, output;        ///< as long as `time`
  Vector reference;            ///< what drives the loop, unrelated to the noise; empty where there is none
  std::optional<double> step;  ///< [s] between samples where the clock is even; absent where it is not
  std::optional<double> held;  ///< input and reference between samples: absent: in straight lines; otherwise each keeps
                               ///< its value for that share of the interval and then jumps to the next (1: ends there)
  Index first = 0;             ///< samples before it are only there for a delayed input
  [[nodiscard]] Index samples() const { return time.size() - first; }
};

/// What the input does between two samples: it keeps the first one's value, or moves in a straight line.
enum class InputHold { zero, first };

[[nodiscard]] constexpr auto word_table(InputHold) {
  using enum InputHold;
  return std::to_array<Word<InputHold>>({{zero, "zero"}, {first, "first"}});
}

/// B(s)/A(s) · e^{−sτ}, or with q⁻¹ in place of s where there is a sample time. In SI units and seconds.
struct TransferFunction {
  Vector numerator;  ///< continuous: b₀ … b_m of s⁰ … sᵐ. Discrete: of q⁻⁰ … q⁻ᵐ.
  Vector denominator;  ///< continuous: a₀ … a_{n−1}, 1 of s⁰ … sⁿ. Discrete: 1, f₁ … f_n of q⁻⁰ … q⁻ⁿ.
  double delay = 0;        ///< τ [s]
  double sample_time = 0;  ///< [s]; 0: continuous
  [[nodiscard]] Index poles() const { return denominator.size() - 1; }
  [[nodiscard]] Index zeros() const { return numerator.size() - 1; }
};

/// How a transfer function is found.
enum class TransferFunctionMethod { srivc, rivc, closed_loop, output_error, box_jenkins };

[[nodiscard]] constexpr auto word_table(TransferFunctionMethod) {
  using enum TransferFunctionMethod;
  return std::to_array<Word<TransferFunctionMethod>>(
      {{srivc, "srivc"}, {rivc, "rivc"}, {closed_loop, "clsrivc"}, {output_error, "oe"}, {box_jenkins, "bj"}});
}

/// Whether its models are of samples; otherwise of continuous time.
[[nodiscard]] constexpr bool is_discrete(TransferFunctionMethod method) {
  return method == TransferFunctionMethod::output_error || method == TransferFunctionMethod::box_jenkins;
}

/// A pole or a zero, as 1/s; of a pair the one above the real axis.
struct Root {
  std::complex<double> value;           ///< [rad/s]
  double frequency = 0;                 ///< |p|/2π [Hz]
  double damping = 0;                   ///< −Re p/|p|; 1 for a real root on the left
  double frequency_standard_error = 0;  ///< [Hz]
  double damping_standard_error = 0;    ///< 0 for a real root, whose damping is not estimated
  bool pair = false;
  bool outside_band = false;  ///< the input hardly excites its frequency: the pole follows from the form of the model
};

/// One start of the search and where it led.
struct SearchStart {
  std::string made_by = {};  ///< how its first model was made, where there are several ways
  double pole = 0;           ///< [rad/s] of the first filter; of several the geometric mean
  bool converged = false;
  bool stable = true;  ///< the solution itself, not what became of it by reflection
  double growth = 0;   ///< [1/s] of the fastest pole of that solution where it is unstable, as far as it is known
  int iterations = 0;
  double fit = 0;  ///< R_T² there
};

/// One line of the table of orders.
struct OrderChoice {
  Index poles = 0, zeros = 0;
  bool usable = false;  ///< converged and stable
  double fit = 0;       ///< R_T² = 1 − var(y − x̂)/var(y)
  double yic = 0;       ///< ln(σ²/σ_y²) + ln(Σ σ² p_jj/θ_j²/n_θ), Young's criterion
  double aic = 0, bic = 0;
  bool chosen = false;
};

/// Whether what is left looks like noise.
struct ResidualTests {
  Index lags = 0;
  double autocorrelation_outside = 0;    ///< share of the lags beyond the 99 % limit of white noise
  double whiteness_p = 0;                ///< probability of so large a Ljung–Box sum in white noise
  double cross_correlation_outside = 0;  ///< share of the lags at which the input still explains something, 99 %
  double cross_p = 0;                    ///< probability of so large a largest cross-correlation
  [[nodiscard]] bool white() const { return whiteness_p > 0.01; }
  [[nodiscard]] bool independent() const { return cross_p > 0.01; }
};

/// A transfer function, how sure it is and how well it holds.
struct TransferFunctionIdentification {
  TransferFunction model;
  TransferFunctionMethod method = TransferFunctionMethod::srivc;
  Matrix covariance;     ///< of [a₀ … a_{n−1}, b₀ … b_m], or of [f₁ … f_n, b_0 … b_m]
  double hac_lag_s = 0;  ///< correlation time of the residual in it; 0: assumed white
  std::vector<Root> poles, zeros;
  double gain = 0, gain_standard_error = 0;  ///< at frequency zero
  double fit = 0;                            ///< R_T² in sample
  double noise_standard_deviation = 0;       ///< of the residual [unit of the output]
  double yic = 0, aic = 0, bic = 0;
  std::optional<double> held_out_fit;  ///< R² of the simulation on data that were held out
  double held_out_rmse = 0;
  std::vector<SimulatedOutput> simulated;  ///< of what was held out; where nothing was, of what the model is made of
  Vector noise_denominator;                ///< C: 1, c₁ … of the noise model e = ε/C(q⁻¹); empty without one
  Vector noise_numerator;                  ///< D: 1, d₁ … with e = D/C ε; empty without one
  double max_delay = 0;                    ///< [s] up to which a delay was looked for; 0: it was given
  bool delay_found = false;                ///< below that one; the longest that was tried is none that was found
  std::optional<double> delay_standard_error;  ///< [s] of a delay that was found, where it is in the covariance
  std::optional<InputHold> hold;               ///< absent for a model in discrete time, which needs none
  bool hold_found = false;                     ///< by the steps of the input
  std::vector<SearchStart> starts;
  std::vector<OrderChoice> orders;  ///< where several were tried
  ResidualTests residuals;
  double band_low = 0, band_high = 0;  ///< [Hz] excited by the input
  bool even = true;                    ///< the samples are on an even clock
  double sample_time = 0;              ///< [s], the median one
  double recorded_rate_hz = 0;         ///< of the recording, where its samples were decimated; 0: they were not
  Index samples = 0, experiments = 0;
  std::string input, output, reference, input_unit, output_unit;  ///< names of channels and their units
  std::vector<SourceFile> sources;
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
  bool usable = true;
};

}  // namespace mbk
