#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::dsp {

/// Autoregressive model of noise, ε_t = e_t + c₁ e_{t−1} + … + c_p e_{t−p}, by least squares on the autocovariance
/// (Yule–Walker, Levinson's recursion), which is always stable; of the orders 0 … most the one of least BIC.
/// @param pieces of one noise, without breaks inside    @returns 1, c₁ … c_p
[[nodiscard]] Vector autoregression(const std::vector<Vector>& pieces, Index most);

}  // namespace mbk::dsp
