#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/random.h"

namespace mbk::recording::test {

/// A signal as it could be recorded, with its name for messages.
struct NamedSignal {
  std::string name;
  Vector values;
};

inline Vector sampled(Index samples, const std::function<double(Index)>& value) {
  Vector values(samples);
  for (Index i = 0; i < samples; ++i) values[i] = value(i);
  return values;
}

/// In steps of q, as an encoder, a converter or a printed number of so many decimals.
inline Vector in_steps(const Vector& values, double q) {
  return values.unaryExpr([q](double v) { return q * std::round(v / q); });
}

inline Vector with_noise(const Vector& values, double sigma, numeric::Random& random) {
  return values.unaryExpr([&](double v) { return v + sigma * random.normal(); });
}

/// Six lines from 0.3 to 4.1 Hz, of RMS amplitude/√2.
inline Vector multisine(Index samples, double rate_hz, double amplitude) {
  constexpr std::array<double, 6> kLines{0.3, 0.7, 1.1, 1.9, 2.9, 4.1}, kPhases{0.3, 4.1, 2.2, 5.5, 1.0, 3.3};
  return sampled(samples, [&](Index i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < kLines.size(); ++k) {
      sum += std::sin(2.0 * std::numbers::pi * kLines[k] * static_cast<double>(i) / rate_hz + kPhases[k]);
    }
    return amplitude * sum / std::sqrt(6.0);
  });
}

/// Underdamped pulses from rest to rest, one a second, to either side in turn.
inline Vector pulses(Index samples, double rate_hz, double amplitude) {
  return sampled(samples, [&](Index i) {
    double sum = 0.0;
    for (int k = 0; k < static_cast<double>(samples) / rate_hz; ++k) {
      const double s = static_cast<double>(i) / rate_hz - k - 0.2;
      if (s > 0.0) sum += (k % 2 == 0 ? 1.0 : -1.0) * std::exp(-s / 0.06) * std::sin(8.0 * std::numbers::pi * s);
    }
    return amplitude * sum;
  });
}

/// The same with each value kept for `period` samples, the first of them.
inline Vector held(const Vector& values, double period) {
  return sampled(values.size(), [&](Index i) {
    return values[static_cast<Index>(std::ceil(std::floor(static_cast<double>(i) / period) * period - 1e-9))];
  });
}

}  // namespace mbk::recording::test
