#pragma once

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mbk/model/trial/exploration_trial.h"

/// Signals for the tests of this module.
namespace mbk::explore {

/// White and normal, variance 1.
inline Vector white_noise(Index samples, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Vector values(samples);
  for (double& value : values) value = normal(random);
  return values;
}

inline Matrix white_noise(Index samples, Index signals, unsigned seed) {
  Matrix values(samples, signals);
  for (Index k = 0; k < signals; ++k) values.col(k) = white_noise(samples, seed + 1000 * static_cast<unsigned>(k));
  return values;
}

/// 1, 3, 5 … up to `last`.
inline std::vector<int> odd_lines(int last) {
  std::vector<int> lines;
  for (int k = 1; k <= last; k += 2) lines.push_back(k);
  return lines;
}

/// Σ cos(2π k i/period + φ_k) with random phases; to be added in the same order for the same seed.
inline Vector periodic_signal(const std::vector<int>& lines, Index period, Index samples, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 2.0 * std::numbers::pi);
  Vector values = Vector::Zero(samples);
  for (const int k : lines) {
    const double phase = uniform(random);
    for (Index i = 0; i < samples; ++i) {
      const auto turn = static_cast<double>(k * (i % period)) / static_cast<double>(period);
      values[i] += std::cos(2.0 * std::numbers::pi * turn + phase);
    }
  }
  return values;
}

/// y[i] = a u[i] + b u[i − 1], whose response is a + b e^(−jωT); at rest before the first sample.
inline Vector two_taps(const Vector& u, double a, double b) {
  Vector y = a * u;
  y.tail(y.size() - 1) += b * u.head(u.size() - 1);
  return y;
}

inline std::complex<double> two_taps_response(double a, double b, double hertz, double step) {
  return a + b * std::polar(1.0, -2.0 * std::numbers::pi * hertz * step);
}

/// A trial of these signals, without units.
inline ExplorationTrial trial_of(const Matrix& input, const Matrix& output, double sample_time,
                                 const Matrix& reference = {}) {
  ExplorationTrial trial;
  trial.axes = static_cast<int>(input.cols());
  trial.sample_time = sample_time;
  trial.input = input;
  trial.output = output;
  trial.reference = reference;
  for (Index k = 0; k < input.cols(); ++k) trial.input_labels.push_back({"u" + std::to_string(k + 1), ""});
  for (Index k = 0; k < output.cols(); ++k) trial.output_labels.push_back({"y" + std::to_string(k + 1), ""});
  trial.split = input.rows();
  return trial;
}

}  // namespace mbk::explore
