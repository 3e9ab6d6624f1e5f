#pragma once

#include <optional>

#include "mbk/base/core/result.h"
#include "mbk/measure/explore/limb_signals.h"
#include "mbk/model/trial/impulse_response_estimate.h"

namespace mbk::explore {

struct ImpulseResponseOptions {
  std::optional<double> memory_s;  ///< [s]; absent: of 0.02 … 0.2 s, by cross-validation
  std::optional<Index> rank;       ///< absent: by cross-validation
};

/// Two-sided impulse response of n inputs and n outputs by the truncated pseudo-inverse (Westwick & Kearney 1997;
/// Perreault, Kirsch & Acosta 1999),
///   −F_h(t) = Σ_l h(l) x(t − l) T + c + e(t),   ĥ = V_r (V_rᵀRᵀX V_r)⁻¹ V_rᵀRᵀ(−F_h)/T
/// with X the lagged motion, V_r the r directions in which R varies most, and R = X, or what the reference explains of
/// X. The memory and r are those of least error in eight-fold cross-validation over consecutive rows; of the memories
/// the shortest whose error is within one standard error of the least. What lies outside V_r was not excited: it is
/// zero in ĥ, and the intervals are those of V_r V_rᵀh, with e an autoregression.
///
/// M, B and K are fitted to the response with its inverse covariance as weights: with a = V_rᵀh T and D the same
/// coefficients of [ẍ ẋ x],
///   θ = (DᵀV⁻¹D)⁻¹DᵀV⁻¹a,   F = (a − Dθ)ᵀV⁻¹(a − Dθ)/(r − 3n)
/// M, B and K are not enough where chance is below 10⁻⁵, Bonferroni over axes. What the lags cannot make of ẍ
/// biases neither, since D has lost the same.
/// @fails  fewer than 20 rows for each coefficient; a force or motion that does not vary
[[nodiscard]] Result<ImpulseResponseEstimate> impulse_response(const LimbSignals& signals,
                                                               const ImpulseResponseOptions& options = {});

}  // namespace mbk::explore
