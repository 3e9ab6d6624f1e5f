#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/study/reliability/support.h"

namespace mbk::reliability {

/// Share of tests of normal errors that warn: at most so large a p is called heavy tails.
inline constexpr double kTailFalseAlarms = 0.04;

/// Kurtosis of residuals against that of normal errors.
struct TailTest {
  double kurtosis = 0;  ///< of the two-way residuals; of normal errors nearly 3
  /// That normal errors of as many rows and columns have so large a kurtosis; 1 where nothing can be tested.
  double p = 1;
  Index row = 0, column = 0;  ///< of the largest residual
};

/// r_ij = x_ij − x̄_i. − x̄_.j + x̄..,  kurtosis N Σ r⁴/(Σ r²)² over all N = n·k of them. All r have the same variance
/// under normal errors, so that this is the kurtosis of the studentised residuals. It depends on neither means nor
/// variance, and p is counted in drawn normal tables of the same size (fixed seed); above 20,000 entries by the normal
/// limit N(3, 24/(n (k − 1))).
/// @param scores  n×k, finite; fewer than kMinPeople rows or 2 columns cannot be tested
[[nodiscard]] TailTest tail_test(const Matrix& scores);

/// The kurtosis that intervals of standard deviations allow for: that of Student's t with six degrees of freedom.
inline constexpr double kTailKurtosis = 6.0;

/// An interval of a standard deviation that supposes normal errors, made to hold up to kTailKurtosis. The variance of
/// ln s, (κ − 1)/4 per degree of freedom, is then 2.5 times that of normal errors, so each end is √2.5 times as far
/// from the estimate on a logarithmic scale. Heavier tails are what tail_test() is for.
[[nodiscard]] Interval widened_for_tails(double estimate, const Interval& normal);

}  // namespace mbk::reliability
