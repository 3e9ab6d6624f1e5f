#include "mbk/model/perturbation/underdamped_filter.h"

#include <fmt/format.h>

#include <cmath>

namespace mbk::perturbation {

Result<UnderdampedFilter> UnderdampedFilter::create(double damping_ratio, RadPerSec natural_frequency) {
  if (!(damping_ratio > 0.0 && damping_ratio < 1.0)) {
    return bad_usage(fmt::format("damping ratio {} is not between 0 and 1", damping_ratio));
  }
  if (!(natural_frequency.value > 0.0 && std::isfinite(natural_frequency.value))) {
    return bad_usage(fmt::format("natural frequency {} rad/s is not positive", natural_frequency.value));
  }
  return UnderdampedFilter(damping_ratio, natural_frequency.value);
}

UnderdampedFilter::UnderdampedFilter(double damping_ratio, double natural_frequency)
    : damping_ratio_(damping_ratio),
      natural_frequency_(natural_frequency),
      decay_(damping_ratio * natural_frequency),
      damped_(natural_frequency * std::sqrt(1.0 - damping_ratio * damping_ratio)) {}

Jet<double> UnderdampedFilter::response(double value, double rate, double input, double t) const {
  const double envelope = std::exp(-decay_ * t);
  const double cosine = envelope * std::cos(damped_ * t);
  const double sine = envelope * std::sin(damped_ * t) / damped_;
  // y − u and each of its derivatives solve the homogeneous equation, each from its own two initial values.
  const double wn2 = natural_frequency_ * natural_frequency_;
  const double z0 = value - input, z1 = rate;
  const double z2 = -2.0 * decay_ * z1 - wn2 * z0, z3 = -2.0 * decay_ * z2 - wn2 * z1;
  const auto solution = [&](double start, double slope) { return start * cosine + (slope + decay_ * start) * sine; };
  return {input + solution(z0, z1), solution(z1, z2), solution(z2, z3)};
}

Hertz UnderdampedFilter::bandwidth() const {
  const double a = 1.0 - 2.0 * damping_ratio_ * damping_ratio_;
  return Hertz(RadPerSec(natural_frequency_ * std::sqrt(a + std::sqrt(a * a + 1.0))));
}

double UnderdampedFilter::power_gain(Hertz frequency) const {
  const double ratio = RadPerSec(frequency).value / natural_frequency_;
  const double real = 1.0 - ratio * ratio, imaginary = 2.0 * damping_ratio_ * ratio;
  return 1.0 / (real * real + imaginary * imaginary);
}

}  // namespace mbk::perturbation
