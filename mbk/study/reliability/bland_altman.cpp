#include "mbk/study/reliability/bland_altman.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::reliability {
namespace {

/// r with Φ(u + r) − Φ(u − r) = content.
double half_width(double u, double content) {
  double low = 0.0, high = std::abs(u) + 9.0;
  const auto inside = [&](double r) { return numeric::normal_probability(u + r) - numeric::normal_probability(u - r); };
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (inside(middle) < content ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

AgreementLimit limit_of(double bias, double s, int people, double normal) {
  const double root = std::sqrt(static_cast<double>(people));
  const auto end = [&](double p) {
    return bias + s * numeric::noncentral_t_quantile(p, people - 1, root * normal) / root;
  };
  return {bias + normal * s, {end(kTail95), end(1.0 - kTail95)}};
}

}  // namespace

double tolerance_factor(int count, double content, double confidence) {
  // The mean is off by z σ/√n; then s must be at least r(z/√n) σ/k. The trapezoidal rule over a normal density is exact
  // to rounding with steps like these.
  constexpr int kSteps = 160;
  constexpr double kReach = 8.0, kStep = kReach / kSteps;
  const double degrees = count - 1, root = std::sqrt(static_cast<double>(count));
  Vector widths(kSteps + 1), weights(kSteps + 1);
  for (int i = 0; i <= kSteps; ++i) {
    const double z = i * kStep;
    widths[i] = half_width(z / root, content);
    weights[i] = (i == 0 ? 1.0 : 2.0) * kStep * std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
  }
  const auto held = [&](double k) {
    double chance = 0.0;
    for (int i = 0; i <= kSteps; ++i) {
      chance += weights[i] * numeric::chi_square_above(degrees * widths[i] * widths[i] / (k * k), degrees);
    }
    return chance;
  };
  double low = widths[0], high = 2.0 * widths[0];
  while (held(high) < confidence) high *= 2.0;
  constexpr int kHalvings = 60;
  for (int i = 0; i < kHalvings && high - low > 1e-12 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (held(middle) < confidence ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

namespace {

/// That of the last number of people is often that of the next.
double tolerance_factor95(int people) {
  thread_local std::pair<int, double> last = {0, 0.0};
  if (last.first != people) last = {people, tolerance_factor(people, 0.95, 0.95)};
  return last.second;
}

}  // namespace

Result<BlandAltman> bland_altman(const Vector& first, const Vector& second) {
  if (first.size() != second.size()) {
    return bad_data(fmt::format("{} first and {} second measurements", first.size(), second.size()),
                    "give both of each person");
  }
  const Vector difference = second - first;
  if (const Index i = first_non_finite(difference); i >= 0) {
    return bad_data(fmt::format("the difference of person {} is not a finite number", i + 1), "omit the person");
  }
  BlandAltman result;
  result.people = static_cast<int>(difference.size());
  if (result.people < kMinPeople) {
    result.support = Support::too_few_people;
    return result;
  }
  result.bias = difference.mean();
  const double s = result.standard_deviation = std::sqrt(numeric::variance(difference));
  if (!(s > 0.0)) result.support = Support::no_variation;
  const double reach =
      numeric::student_quantile(1.0 - kTail95, result.people - 1) * s / std::sqrt(static_cast<double>(result.people));
  result.bias95 = {result.bias - reach, result.bias + reach};
  result.upper = limit_of(result.bias, s, result.people, kPublishedNormal95);
  result.lower = limit_of(result.bias, s, result.people, -kPublishedNormal95);
  const double k = tolerance_factor95(result.people);
  result.tolerance95 = {result.bias - k * s, result.bias + k * s};
  return result;
}

}  // namespace mbk::reliability
