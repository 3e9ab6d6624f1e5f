#pragma once

#include <random>
#include <string>

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
