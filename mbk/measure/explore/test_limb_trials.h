#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/measure/explore/test_signals.h"

/// Limbs whose response is known, at the rate at which responses are fitted: nothing is filtered or decimated.
namespace mbk::explore {

inline constexpr double kStep = 0.008;  ///< [s]

/// A random binary sequence of ±1 behind four equal low-passes.
inline Vector binary_motion(Index samples, std::uint64_t seed, double corner_hz = 8.0) {
  numeric::Random random(seed, 7);
  const double keep = std::exp(-2.0 * std::numbers::pi * corner_hz * kStep);
  Vector x(samples), state = Vector::Zero(4);
  double level = 1.0;
  for (Index i = 0, until = 0; i < samples; ++i) {
    if (i >= until) {
      level = random.uniform() < 0.5 ? -1.0 : 1.0;
      until = i + 4 + static_cast<Index>(random.below(24));
    }
    double input = level;
    for (double& one : state) input = one = keep * one + (1.0 - keep) * input;
    x[i] = state[3];
  }
  return x;
}

/// e_t = 0.9 e_{t−1} + ε_t, of variance 1.
inline Vector coloured_noise(Index samples, std::uint64_t seed) {
  numeric::Random random(seed, 11);
  constexpr double kKeep = 0.9;
  Vector e(samples);
  double state = random.normal();
  for (double& value : e) value = state = kKeep * state + std::sqrt(1.0 - kKeep * kKeep) * random.normal();
  return e;
}

/// y_t = Σ_l h_l u_{t−l}, l = first …, term by term; beyond the ends u is 0.
inline Vector convolved(const Vector& u, const Vector& h, Index first) {
  Vector y = Vector::Zero(u.size());
  for (Index t = 0; t < u.size(); ++t) {
    for (Index k = 0; k < h.size(); ++k) {
      const Index from = t - first - k;
      if (from >= 0 && from < u.size()) y[t] += h[k] * u[from];
    }
  }
  return y;
}

/// Central differences of nine points are what limb_signals makes of these; so are the velocities here.
inline Vector velocity_of(const Vector& x) {
  constexpr double kWeights[] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  Vector v = Vector::Zero(x.size());
  for (Index t = 4; t + 4 < x.size(); ++t) {
    for (Index k = 1; k <= 4; ++k) v[t] += kWeights[k - 1] * (x[t + k] - x[t - k]) / kStep;
  }
  return v;
}

/// T G ω²/(s² + 2ω s + ω²) e^{−s d} at lags 0, T, …, critically damped.
inline Vector reflex_response(double gain, double natural, double delay, Index lags) {
  Vector g = Vector::Zero(lags);
  for (Index k = 0; k < lags; ++k) {
    const double t = kStep * static_cast<double>(k) - delay;
    if (t > 0.0) g[k] = kStep * gain * natural * natural * t * std::exp(-natural * t);
  }
  return g;
}

}  // namespace mbk::explore
