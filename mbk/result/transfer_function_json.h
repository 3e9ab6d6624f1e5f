#pragma once

#include <string>

#include "mbk/trial/transfer_function.h"

namespace mbk::result {

/// Schema "mbk.tf/1". Numerator and denominator from the highest power of s to the constant, as tf(num, den) of
/// control packages takes them; the covariance is of [a₀ … a_{n−1}, b₀ … b_m].
[[nodiscard]] std::string to_json(const TransferFunctionIdentification& found);

}  // namespace mbk::result
