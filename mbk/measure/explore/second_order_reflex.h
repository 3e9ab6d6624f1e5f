#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/parallel_cascade_estimate.h"

namespace mbk::explore {

/// Second-order low-pass behind a delay, fitted to a response by weighted least squares (Mirbagheri, Barbeau & Kearney
/// 2000),
///   min Σ_j (a_j − Vᵀg_j)ᵀ C_j⁻¹ (a_j − Vᵀg_j),   g_j(l) = G_j ∫ h(l T + τ) (1 − |τ|/T) dτ
/// with h the impulse response of ω²/(s² + 2ζωs + ω²) e^{−s d}, for an input that runs in straight lines between
/// samples, and ω, ζ and d in common to the axes, by Levenberg & Marquardt's method from several starts. Intervals are
/// those of the linearised fit, wider by √F where it leaves F > 1.
/// @param directions V, lags×r    @param coefficients a, r×n    @param covariance C, n of r×r
/// @param first  lag of the first row [samples]    @param freedom  of the covariances
/// @returns none where no start leads to a response within the lags
[[nodiscard]] std::optional<SecondOrderReflex> fit_second_order(const Matrix& directions, const Matrix& coefficients,
                                                                const std::vector<Matrix>& covariance,
                                                                double sample_time, Index first, double freedom);

}  // namespace mbk::explore
