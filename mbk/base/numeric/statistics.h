#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::numeric {

/// z with P(|Z| < z) = 0.95 for a standard normal Z.
inline constexpr double kNormal95 = 1.959963984540054;
inline constexpr double kNormal99 = 2.5758293035489004;  ///< Φ⁻¹(0.995)

/// Σ(x − x̄)²/(n − 1), in two passes; 0 for fewer than two values.
[[nodiscard]] double variance(const Eigen::Ref<const Vector>& values);

/// Variance accounted for, 100 (1 − var(f − f̂)/var(f)) [%]   (Dyck 2013, eq. 3.10).
/// It ignores a constant error and may be negative: always show the RMSE beside it. NaN where f is constant.
[[nodiscard]] double variance_accounted_for(const Vector& measured, const Vector& residual);

/// The least and the greatest of some values.
struct Extremes {
  double min, max;
};

/// Of values that are all finite; NaN where one is not, or there is none.
[[nodiscard]] Extremes finite_extremes(const Eigen::Ref<const Vector>& values);

/// √(mean of squares).
[[nodiscard]] double root_mean_square(const Vector& values);

/// Interval of a positive quantity whose logarithm is taken as normal: value · exp(±1.96 se/value). It cannot cross 0.
[[nodiscard]] std::pair<double, double> positive_interval95(double value, double standard_error);

/// value ± 1.96 se.
[[nodiscard]] std::pair<double, double> interval95(double value, double standard_error);

/// Φ(z), P(Z ≤ z) of a standard normal Z.
[[nodiscard]] double normal_probability(double z);

/// Φ⁻¹(p); −∞ for p ≤ 0, ∞ for p ≥ 1.
[[nodiscard]] double normal_quantile(double p);

/// Quantile p of sorted values, by linear interpolation; NaN without values.
/// @param sorted rising    @param p in [0, 1]
[[nodiscard]] double quantile(const Eigen::Ref<const Vector>& sorted, double p);

/// The value in the middle, or the mean of the two in the middle; NaN where there are none.
[[nodiscard]] double median(std::vector<double> values);

/// Hands all of some values to `use`, block by block; the same ones in the same order each time it is called.
using EachBlock = std::function<void(const std::function<void(std::span<const double>)>& use)>;

/// The same median of values that are too many to be copied, by counting them: in five passes, each of which settles 16
/// bits of it.
/// @param count  of the values    @param each_block  of values that are 0 or more, and finite
[[nodiscard]] double median_of_many(Index count, const EachBlock& each_block);

/// The value in the middle, the greater of two: one of those that are there. NaN where there are none.
[[nodiscard]] double upper_median(std::vector<double> values);

/// Exact (Clopper–Pearson) interval of a binomial proportion, by the quantiles of beta distributions.
/// @param successes 0…trials    @param confidence e.g. 0.99
[[nodiscard]] std::pair<double, double> binomial_interval(int successes, int trials, double confidence);

/// Probability of at least this number of successes.   @param share  probability of success in one trial, 0…1
[[nodiscard]] double binomial_at_least(int successes, int trials, double share);

/// Probability of at most this number of successes.   @param share  probability of success in one trial, 0…1
[[nodiscard]] double binomial_at_most(int successes, int trials, double share);

}  // namespace mbk::numeric
