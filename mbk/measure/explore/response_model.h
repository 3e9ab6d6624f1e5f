#pragma once

#include "mbk/measure/explore/lagged_regression.h"
#include "mbk/model/trial/impulse_response_estimate.h"

namespace mbk::explore {

/// M, B and K by weighted least squares on the coefficients a of an impulse response,
///   θ_i = (DᵀV_i⁻¹D)⁻¹DᵀV_i⁻¹a_i,   F_i = (a_i − Dθ_i)ᵀV_i⁻¹(a_i − Dθ_i)/(r − 3n)
/// @param D r×3n, the coefficients that the same estimator gives [ẍ ẋ x] in place of the force
/// @param fit  its first r coefficients are those of the response
/// @returns not identifiable where r < 3n or the columns of D cannot be distinguished
[[nodiscard]] ResponseModel fit_response_model(const Matrix& D, const LaggedFit& fit, Index n);

}  // namespace mbk::explore
