#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::identify {

struct TransferFunctionOptions {
  TransferFunctionMethod method = TransferFunctionMethod::srivc;
  Index poles = 2, zeros = 1;
  std::vector<std::pair<Index, Index>> orders;  ///< poles and zeros to choose from; empty: those above
  std::vector<double> start_poles;              ///< [rad/s], tried beside those that the method takes by itself
  double delay = 0.0;                           ///< τ [s] ≥ 0
  bool find_delay = false;                      ///< instead of the one above, up to max_delay
  double max_delay = 0.5;                       ///< [s]
  std::optional<InputHold> hold;                ///< of the input; absent: as its steps show (input_hold)
  bool free_start = true;                       ///< an initial state and an offset of the output for each experiment
  Index max_noise_order = 8;                    ///< of the noise model, where the method has one
  double hac_lag_s = 1.0;                       ///< correlation time of the residual in the standard errors [s]
  unsigned threads = 0;                         ///< 0: as many as there are cores
};

/// One transfer function behind all experiments, with intervals of its coefficients, poles, zeros and gain, the table
/// of orders, and tests of what is left.
///   Order: of the models that settled, those that leave at most 2 % more variance than the one that leaves least; of
/// these the one of least YIC (Young 1989). Delay: the one that leaves least, by whole samples first (an
/// eighth of the period apart below which 95 % of the output's power lies) and then by golden section to a hundredth of
/// a sample. At the longest that is tried it has no interval, and is warned of. Its uncertainty is part of the
/// covariance, except with as many zeros as poles. In discrete time (output error, Box–Jenkins; prediction_error.h) the
/// delay is a whole number of samples, of one even clock, taken as known, and the hold is part of the model.
/// @param held_out  judged by simulation alone, with an initial state and an offset of their own
/// @fails  not usable: no start settled on a stable model. As fit_continuous or fit_prediction_error
/// otherwise; delay < 0 or not finite, or in discrete time no whole number of samples; a delayed input that is held on
/// an uneven clock; a hold for a model in discrete time.
[[nodiscard]] Result<TransferFunctionIdentification> identify_transfer_function(
    const std::vector<SignalPair>& experiments, const std::vector<SignalPair>& held_out,
    const TransferFunctionOptions& options);

/// Poles or zeros with intervals by the delta method: dp = −Σ pᵏ da_k/A′(p). With a sample time they are roots z of a
/// polynomial of z, given as p = ln z/T and dp = dz/(zT); the imaginary part of a negative one is that of Nyquist, and
/// a root at 0, which only delays, is left out.
/// @param ascending c₀ … cₙ    @param covariance of its first coefficients; those behind them are known
/// @param sample_time T [s]; 0: continuous
[[nodiscard]] std::vector<Root> roots_with_intervals(const Vector& ascending, const Matrix& covariance,
                                                     double sample_time = 0.0);

/// Whiteness by the sum of Ljung & Box (1978). The relation to the input by the largest of the cross-correlations at
/// lags 0 … `lags`, of residual and input both behind the residual's autoregressive model, at Bonferroni's level: it is
/// for an input that no noise reaches, and so in a loop for what the reference makes of it.
/// @param residuals of each experiment    @param inputs as long as these, without their means    @param lags ≥ 1
[[nodiscard]] ResidualTests test_residuals(const std::vector<Vector>& residuals, const std::vector<Vector>& inputs,
                                           Index lags);

}  // namespace mbk::identify
