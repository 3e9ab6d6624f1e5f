#include "mbk/base/numeric/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mbk::numeric {

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
  double low = -40.0, high = 40.0;
  for (int i = 0; i < 64; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_probability(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

namespace {

/// P(|T| ≤ t), t ≥ 0.
double student_within(double t, int degrees_of_freedom) {
  const double angle = std::atan2(t, std::sqrt(degrees_of_freedom));
  const double c = std::cos(angle), s = std::sin(angle);
  const bool odd = degrees_of_freedom % 2 == 1;
  double term = odd ? c : 1.0, sum = degrees_of_freedom == 1 ? 0.0 : term;
  for (int k = odd ? 3 : 2; k < degrees_of_freedom; k += 2) {
    term *= c * c * static_cast<double>(k - 1) / static_cast<double>(k);
    sum += term;
  }
  return odd ? (angle + s * sum) * 2.0 / std::numbers::pi : s * sum;
}

}  // namespace

double student_quantile(double p, int degrees_of_freedom) {
  const double within = std::abs(2.0 * p - 1.0);
  double high = 1.0;
  while (high < 1e300 && student_within(high, degrees_of_freedom) < within) high *= 2.0;
  double low = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (student_within(middle, degrees_of_freedom) < within ? low : high) = middle;
  }
  return std::copysign(0.5 * (low + high), p - 0.5);
}

double quantile(const Eigen::Ref<const Vector>& sorted, double p) {
  if (sorted.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = std::min(static_cast<Index>(place), sorted.size() - 1);
  const Index above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

namespace {

/// P(X ≤ k) for X ~ Binomial(n, p).
double binomial_at_most(int k, int n, double p) {
  if (k >= n || p <= 0.0) return 1.0;
  if (p >= 1.0) return 0.0;
  double sum = 0.0;
  for (int i = 0; i <= k; ++i) {
    sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0) + i * std::log(p) +
                    (n - i) * std::log1p(-p));
  }
  return sum;
}

}  // namespace

std::pair<double, double> binomial_interval(int successes, int trials, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  // Both tails fall or rise monotonically in p, so that each limit is found by bisection.
  const auto solve = [&](auto&& too_low) {
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (too_low(middle) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  };
  const double lower =
      successes == 0 ? 0.0 : solve([&](double p) { return 1.0 - binomial_at_most(successes - 1, trials, p) < tail; });
  const double upper =
      successes == trials ? 1.0 : solve([&](double p) { return binomial_at_most(successes, trials, p) > tail; });
  return {lower, upper};
}

}  // namespace mbk::numeric
