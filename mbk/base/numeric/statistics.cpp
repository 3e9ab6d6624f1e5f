#include "mbk/base/numeric/statistics.h"

#include <algorithm>
#include <array>
#include <bit>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "mbk/base/core/units.h"
#include "mbk/base/core/vector4.h"

namespace mbk::numeric {
namespace {

/// The values that stand in the middle of sorted ones, at n/2 − 1 and n/2.
struct Middle {
  double lower, upper;
};

Middle middle_by_order(std::span<double> values, std::size_t upper) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(upper);
  std::nth_element(values.begin(), middle, values.end());
  return {upper > 0 ? *std::max_element(values.begin(), middle) : *middle, *middle};
}

/// NaN where there are no values, which change their places. Of many, two of a sample nearly always enclose the middle,
/// and then few are left to be put in order.
Middle middle_of(std::vector<double>& values) {
  constexpr std::size_t kMany = 4096, kSample = 255, kAround = 24;
  if (values.empty()) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const std::size_t upper = values.size() / 2;
  if (values.size() < kMany) return middle_by_order(values, upper);
  std::array<double, kSample> sample{};
  for (std::size_t k = 0; k < kSample; ++k) sample[k] = values[k * (values.size() / kSample)];
  std::ranges::sort(sample);
  const double low = sample[kSample / 2 - kAround], high = sample[kSample / 2 + kAround];
  std::vector<double> between(values.size());
  std::size_t below = 0, count = 0;
  for (const double value : values) {
    between[count] = value;
    below += value < low ? 1 : 0;
    count += value >= low && value <= high ? 1 : 0;
  }
  if (upper < below + 1 || upper >= below + count) return middle_by_order(values, upper);
  if (low == high) return {low, low};
  return middle_by_order(std::span(between).first(count), upper - below);
}

/// Σ (x − less)^Power, in sums that do not wait for each other.
template <class Lanes, int Power>
[[gnu::always_inline]] inline double power_sum(const double* x, Index count, double less) {
  constexpr Index kSums = 4, kRows = kSums * Lanes::kWidth;
  typename Lanes::V sums[kSums] = {};
  Index t = 0;
  for (; t + kRows <= count; t += kRows) {
    for (Index i = 0; i < kSums; ++i) {
      const typename Lanes::V one = Lanes::at(x + t + i * Lanes::kWidth) - less;
      sums[i] += Power == 2 ? one * one : one;
    }
  }
  const typename Lanes::V all = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  double sum = 0.0;
  for (Index i = 0; i < Lanes::kWidth; ++i) sum += all[i];
  for (; t < count; ++t) sum += Power == 2 ? (x[t] - less) * (x[t] - less) : x[t] - less;
  return sum;
}

/// Σ (x − x̄)².
template <class Lanes>
[[gnu::always_inline]] inline double squares_body(const double* x, Index count) {
  return power_sum<Lanes, 2>(x, count, power_sum<Lanes, 1>(x, count, 0.0) / static_cast<double>(count));
}
double squares_any(const double* x, Index count) {
  return squares_body<Four>(x, count);
}
MBK_X86_64_V3 double squares_v3(const double* x, Index count) {
  return squares_body<Four>(x, count);
}
MBK_X86_64_V4 double squares_v4(const double* x, Index count) {
  return squares_body<Eight>(x, count);
}

/// Whether all are finite is seen by the sum of x − x, which is 0 then.
template <class Lanes>
[[gnu::always_inline]] inline Extremes extremes_body(const double* x, Index count) {
  constexpr Index kAtOnce = 4, kRows = kAtOnce * Lanes::kWidth;
  const double infinity = std::numeric_limits<double>::infinity();
  typename Lanes::V least[kAtOnce], greatest[kAtOnce], nothing[kAtOnce] = {};
  for (Index i = 0; i < kAtOnce; ++i) {
    least[i] = infinity + typename Lanes::V{};
    greatest[i] = -infinity + typename Lanes::V{};
  }
  Index t = 0;
  for (; t + kRows <= count; t += kRows) {
    for (Index i = 0; i < kAtOnce; ++i) {
      const typename Lanes::V one = Lanes::at(x + t + i * Lanes::kWidth);
      nothing[i] += one - one;
      least[i] = one < least[i] ? one : least[i];
      greatest[i] = one > greatest[i] ? one : greatest[i];
    }
  }
  Extremes found{infinity, -infinity};
  double sum = 0.0;
  const auto take = [&](double low, double high, double difference) {
    found = {std::min(found.min, low), std::max(found.max, high)};
    sum += difference;
  };
  for (Index i = 0; i < kAtOnce; ++i) {
    for (Index k = 0; k < Lanes::kWidth; ++k) take(least[i][k], greatest[i][k], nothing[i][k]);
  }
  for (; t < count; ++t) take(x[t], x[t], x[t] - x[t]);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return count > 0 && sum == 0.0 ? found : Extremes{nan, nan};
}
Extremes extremes_any(const double* x, Index count) {
  return extremes_body<Four>(x, count);
}
MBK_X86_64_V3 Extremes extremes_v3(const double* x, Index count) {
  return extremes_body<Four>(x, count);
}
MBK_X86_64_V4 Extremes extremes_v4(const double* x, Index count) {
  return extremes_body<Eight>(x, count);
}

}  // namespace

double variance(const Eigen::Ref<const Vector>& values) {
  if (values.size() < 2) return 0.0;
  const auto squares = has_x86_64_v4() ? squares_v4 : has_x86_64_v3() ? squares_v3 : squares_any;
  return squares(values.data(), values.size()) / static_cast<double>(values.size() - 1);
}

Extremes finite_extremes(const Eigen::Ref<const Vector>& values) {
  const auto extremes = has_x86_64_v4() ? extremes_v4 : has_x86_64_v3() ? extremes_v3 : extremes_any;
  return extremes(values.data(), values.size());
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
  if (std::isnan(p)) return p;
  if (p <= 0.0) return -kInfinity;
  if (p >= 1.0) return kInfinity;
  return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p);
}

double quantile(const Eigen::Ref<const Vector>& sorted, double p) {
  if (sorted.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = std::min(static_cast<Index>(place), sorted.size() - 1);
  const Index above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double median(std::vector<double> values) {
  const auto [lower, upper] = middle_of(values);
  return values.size() % 2 == 1 ? upper : 0.5 * (lower + upper);
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
  return middle_of(values).upper;
}

std::pair<double, double> binomial_interval(int successes, int trials, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  const double k = successes, n = trials;
  const double lower = successes == 0 ? 0.0 : boost::math::ibeta_inv(k, n - k + 1.0, tail);
  const double upper = successes == trials ? 1.0 : boost::math::ibetac_inv(k + 1.0, n - k, tail);
  return {lower, upper};
}

double binomial_at_least(int successes, int trials, double share) {
  if (successes <= 0) return 1.0;
  if (successes > trials || share <= 0.0) return 0.0;
  return share >= 1.0 ? 1.0 : boost::math::ibeta(double(successes), double(trials - successes) + 1.0, share);
}

double binomial_at_most(int successes, int trials, double share) {
  if (successes >= trials) return 1.0;
  if (successes < 0 || share >= 1.0) return 0.0;
  return share <= 0.0 ? 1.0 : boost::math::ibetac(double(successes) + 1.0, double(trials - successes), share);
}

}  // namespace mbk::numeric
