#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/frequency_response.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::analyse {

/// H(jω) = B(jω)/A(jω) e^{−jωτ}, or at q = e^{jωT} where there is a sample time, with intervals by the delta method:
///   δH/H = Σ δb_k xᵏ/B − Σ δa_k xᵏ/A   with x = jω or e^{−jωT}.
/// The delay is taken as known.
/// @param covariance of [a₀ … a_{n−1}, b₀ … b_m], or of [f₁ … f_n, b₀ … b_m]
/// @param frequency [Hz], rising, > 0; steps without a jump of the phase by more than half a turn
[[nodiscard]] FrequencyResponse frequency_response(const TransferFunction& model, const Matrix& covariance,
                                                   const Vector& frequency);

/// Where a model is looked at: on a logarithmic grid over the excited band and three times beyond it at both ends, with
/// its poles and zeros, up to half the sample rate; more densely around those that hardly are damped.
/// @param within_band  no farther than the excited band, where it is known
[[nodiscard]] Vector frequencies_of(const TransferFunctionIdentification& found, bool within_band);

/// Z = (jω)^k/H with k = −1, 0, 1 for position, velocity, acceleration; M, B, K with their standard errors.
/// @fails  usage: a delay, which an inverse would have to look ahead of.
[[nodiscard]] Result<InvertedAdmittance> inverted(const TransferFunctionIdentification& found, AdmittanceOutput output);

/// Everything that is shown of a transfer function beside itself.
/// @param admittance_to  what the output is, where its inverse is wanted
[[nodiscard]] Result<TransferFunctionFindings> describe(const TransferFunctionIdentification& found,
                                                        std::optional<AdmittanceOutput> admittance_to);

}  // namespace mbk::analyse
