#pragma once

#include <span>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/plateau_stiffness.h"

namespace mbk::explore {

/// Minimum number of displacements.
inline constexpr int kMinDisplacements = 6;

/// K = Σ f zᵀ (Σ d zᵀ)⁻¹ and, with a_i = (Σ z dᵀ)⁻¹ z_i, e_i = f_i − K d_i, h_i = a_iᵀ d_i,
///   cov(K_ak, K_bl) = Σ_i a_ik a_il e_ia e_ib/(1 − h_i)
/// clustered by displacement, so that errors of the axes may hang together and differ in size (MacKinnon & White 1985,
/// HC2); degrees of freedom by Bell & McCaffrey (2002). The ellipses' intervals are left to the caller.
/// @fails  data: fewer than kMinDisplacements; with two axes, displacements along one line; a value is not finite.
[[nodiscard]] Result<StiffnessRegression> regress_stiffness(std::span<const DisplacedHand> displaced);

}  // namespace mbk::explore
