#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::analyse {

/// H(jω) = B(jω)/A(jω) e^{−jωτ}, or at q = e^{jωT} where there is a sample time, with intervals by the delta method:
///   δH/H = Σ δb_k xᵏ/B − Σ δa_k xᵏ/A   with x = jω or e^{−jωT}.
/// The delay is treated as known.
/// @param covariance of [a₀ … a_{n−1}, b₀ … b_m], or of [f₁ … f_n, b₀ … b_m]
/// @param frequency [Hz], rising, > 0; steps without a jump of the phase by more than half a turn
[[nodiscard]] FrequencyResponse frequency_response(const TransferFunction& model, const Matrix& covariance,
                                                   const Vector& frequency);

/// Frequencies at which a model is evaluated: a logarithmic grid over the excited band, its poles and zeros and a
/// factor of three beyond at both ends, up to half the sample rate; denser around lightly damped poles and zeros.
/// @param within_band  only the excited band, if it is known
[[nodiscard]] Vector frequencies_of(const TransferFunctionIdentification& found, bool within_band);

/// Z = (jω)^k/H with k = −1, 0, 1 for position, velocity, acceleration; M, B, K with their standard errors.
/// @fails  usage: the model has a delay, whose inverse is not causal.
[[nodiscard]] Result<InvertedAdmittance> inverted(const TransferFunctionIdentification& found, AdmittanceOutput output);

/// Derived quantities of a transfer function for display.
/// @param admittance_to  kind of output, if the inverse is wanted
[[nodiscard]] Result<TransferFunctionFindings> describe(const TransferFunctionIdentification& found,
                                                        std::optional<AdmittanceOutput> admittance_to);

}  // namespace mbk::analyse
