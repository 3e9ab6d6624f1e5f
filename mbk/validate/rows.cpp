#include "mbk/validate/rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::validation {
namespace {

constexpr double kConfidence = 0.95;

/// Successes whose whole interval (numeric::binomial_interval) is accepted: those from `first` to `last`; none where
/// first > last. The lower end of the interval rises with the successes, as does the upper one, and whether an end lies
/// beyond a share is told by the probability there, without the end itself.
std::pair<int, int> accepted_counts(Range expected, int trials) {
  constexpr double kTail = 0.5 * (1.0 - kConfidence);
  const auto first_where = [&](const auto& holds) {
    int low = 0, high = trials + 1;
    while (low < high) {
      const int middle = std::midpoint(low, high);
      if (holds(middle)) {
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    return low;
  };
  const double least = expected.first / 100.0, most = expected.second / 100.0;
  return {
      first_where([&](int count) { return least <= 0.0 || numeric::binomial_at_least(count, trials, least) <= kTail; }),
      first_where([&](int count) { return most < 1.0 && numeric::binomial_at_most(count, trials, most) > kTail; }) - 1};
}

int trials_in(int runs, const JudgedShare& judged) {
  return static_cast<int>(runs * judged.trials_per_run);
}

}  // namespace

Range at_least(double limit) {
  return {limit, kInfinity};
}

Range at_most(double limit) {
  return {-kInfinity, limit};
}

ValidationRow share_row(std::string what, int hits, int trials, std::optional<Range> expected) {
  ValidationRow row = exact_row(std::move(what), kNaN, expected, "%");
  row.interval95 = {0.0, 100.0};
  row.trials = trials;
  if (trials == 0) return row;
  const auto [low, high] = numeric::binomial_interval(hits, trials, kConfidence);
  row.value = 100.0 * hits / trials;
  row.interval95 = {100.0 * low, 100.0 * high};
  return row;
}

ValidationRow mean_row(std::string what, const Vector& values, std::optional<Range> expected, std::string unit) {
  ValidationRow row = exact_row(std::move(what), values.mean(), expected, std::move(unit));
  const auto count = static_cast<int>(values.size());
  row.interval95 = {-kInfinity, kInfinity};
  if (count < 2) return row;
  row.spread = std::sqrt(numeric::variance(values));
  const double t = numeric::student_quantile(0.5 * (1.0 + kConfidence), count - 1);
  const double reach = t * *row.spread / std::sqrt(static_cast<double>(count));
  row.interval95 = {row.value - reach, row.value + reach};
  return row;
}

ValidationRow bias_row(std::string what, const Vector& errors, double allowed, std::string unit) {
  return mean_row(std::move(what), errors, Range{-allowed, allowed}, std::move(unit));
}

ValidationRow median_row(std::string what, const Vector& values, std::optional<Range> expected, std::string unit) {
  Vector sorted = values;
  std::ranges::sort(sorted);
  ValidationRow row = exact_row(std::move(what), numeric::quantile(sorted, 0.5), expected, std::move(unit));
  const Index count = sorted.size();
  double fewer = std::pow(0.5, static_cast<double>(count)), of_this = fewer;  // P(fewer than k below), k = 1
  Index k = 0;
  while (2.0 * fewer <= 1.0 - kConfidence) {
    ++k;
    of_this *= static_cast<double>(count - k + 1) / static_cast<double>(k);
    fewer += of_this;
  }
  row.interval95 = {-kInfinity, kInfinity};
  if (k > 0) row.interval95 = {sorted[k - 1], sorted[count - k]};
  return row;
}

ValidationRow spread_row(std::string what, const Vector& values, double known, Range expected) {
  const auto count = static_cast<int>(values.size());
  ValidationRow row = exact_row(std::move(what), kNaN, expected, "");
  row.interval95 = {0.0, kInfinity};
  if (count < 2) return row;
  const double ratio = std::sqrt(numeric::variance(values)) / known;
  const double degrees = count - 1;
  row.value = ratio;
  row.interval95 = {ratio * std::sqrt(degrees / numeric::chi_square_quantile(0.5 * (1.0 + kConfidence), count - 1)),
                    ratio * std::sqrt(degrees / numeric::chi_square_quantile(0.5 * (1.0 - kConfidence), count - 1))};
  return row;
}

ValidationRow exact_row(std::string what, double value, std::optional<Range> expected, std::string unit) {
  ValidationRow row;
  row.what = std::move(what);
  row.value = value;
  row.expected = expected;
  row.unit = std::move(unit);
  return row;
}

int min_runs(const JudgedShare& judged) {
  for (int runs = 1;; ++runs) {
    const auto [first, last] = accepted_counts(judged.expected, trials_in(runs, judged));
    if (first <= last) return runs;
  }
}

double chance_to_be_met(Range expected, double share, int trials) {
  const auto [first, last] = accepted_counts(expected, trials);
  const double n = trials, p = share / 100.0;
  if (p <= 0.0 || p >= 1.0) return (p <= 0.0 ? first == 0 && last >= 0 : last == trials && first <= last) ? 1.0 : 0.0;
  double chance = 0.0;
  for (int k = first; k <= last; ++k) {
    chance += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(p) +
                       (n - k) * std::log1p(-p));
  }
  return chance;
}

int default_runs(const JudgedShare& judged) {
  constexpr double kSurely = 0.999;
  for (int decade = 10;; decade *= 10) {
    for (const double step : {1.0, 1.5, 2.0, 2.5, 3.0, 5.0}) {
      const auto runs = static_cast<int>(step * decade);
      if (chance_to_be_met(judged.expected, judged.share, trials_in(runs, judged)) >= kSurely) return runs;
    }
  }
}

}  // namespace mbk::validation
