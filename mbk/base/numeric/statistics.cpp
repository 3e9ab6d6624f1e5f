#include "mbk/base/numeric/statistics.h"

#include <algorithm>
#include <array>
#include <bit>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/complement.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace mbk::numeric {
namespace {

/// The value in the middle, behind which the greater ones then stand; NaN where there are none.
double upper_median_of(std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double variance(const Eigen::Ref<const Vector>& values) {
  if (values.size() < 2) return 0.0;
  return (values.array() - values.mean()).square().sum() / static_cast<double>(values.size() - 1);
}

double variance_accounted_for(const Vector& measured, const Vector& residual) {
  const double total = variance(measured);
  if (!(total > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return 100.0 * (1.0 - variance(residual) / total);
}

double root_mean_square(const Vector& values) {
  return values.size() == 0 ? 0.0 : std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

std::pair<double, double> positive_interval95(double value, double standard_error) {
  const double factor = std::exp(kNormal95 * standard_error / value);
  return {value / factor, value * factor};
}

std::pair<double, double> interval95(double value, double standard_error) {
  return {value - kNormal95 * standard_error, value + kNormal95 * standard_error};
}

double normal_probability(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

double normal_quantile(double p) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (std::isnan(p)) return p;
  if (p <= 0.0) return -kInfinity;
  if (p >= 1.0) return kInfinity;
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p);
}

double student_quantile(double p, int degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), p);
}

double chi_square_quantile(double p, int degrees_of_freedom) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), p);
}

double f_probability_above(double value, double numerator, double denominator) {
  if (!(value > 0.0)) return 1.0;
  if (!std::isfinite(value)) return 0.0;
  return boost::math::cdf(boost::math::complement(boost::math::fisher_f(numerator, denominator), value));
}

double quantile(const Eigen::Ref<const Vector>& sorted, double p) {
  if (sorted.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = std::min(static_cast<Index>(place), sorted.size() - 1);
  const Index above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double median(std::vector<double> values) {
  const double upper = upper_median_of(values);
  if (values.size() % 2 == 1 || values.empty()) return upper;
  const auto middle = values.begin() + std::ssize(values) / 2;
  return 0.5 * (upper + *std::max_element(values.begin(), middle));
}

double median_of_many(Index count, const EachBlock& each_block) {
  constexpr Index kFew = 1 << 17;
  if (count <= kFew) {
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(count));
    each_block([&](std::span<const double> block) { values.insert(values.end(), block.begin(), block.end()); });
    return median(std::move(values));
  }
  // The bits of numbers that are not negative rise with them.
  constexpr int kDigit = 16;
  std::uint64_t known = 0;
  Index rank = count / 2, below = 0;  // rank: among those that begin with the known bits
  std::vector<Index> found(std::size_t{1} << kDigit);
  for (int shift = 64 - kDigit; shift >= 0; shift -= kDigit) {
    std::ranges::fill(found, 0);
    const int seen = shift + kDigit;
    each_block([&](std::span<const double> block) {
      for (const double value : block) {
        const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);  // −0 becomes 0
        if (seen == 64 || bits >> seen == known) ++found[(bits >> shift) & (found.size() - 1)];
      }
    });
    std::size_t digit = 0;
    for (; rank >= found[digit]; ++digit) {
      rank -= found[digit];
      below += found[digit];
    }
    known = known << kDigit | digit;
  }
  const auto upper = std::bit_cast<double>(known);
  if (count % 2 == 1 || below < count / 2) return upper;  // otherwise the one before is less
  double lower = 0.0;
  each_block([&](std::span<const double> block) {
    for (const double value : block) {
      if (value < upper) lower = std::max(lower, value);
    }
  });
  return 0.5 * (upper + lower);
}

double upper_median(std::vector<double> values) {
  return upper_median_of(values);
}

std::pair<double, double> binomial_interval(int successes, int trials, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  const double k = successes, n = trials;
  const double lower = successes == 0 ? 0.0 : boost::math::ibeta_inv(k, n - k + 1.0, tail);
  const double upper = successes == trials ? 1.0 : boost::math::ibetac_inv(k + 1.0, n - k, tail);
  return {lower, upper};
}

}  // namespace mbk::numeric
