#pragma once

#include <memory>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::dsp {

/// Discrete Fourier transforms of complex signals of one length, X_k = Σ_i x_i e^(−2πj i k/n), k = 0 … n − 1:
/// Stockham's form of the fast Fourier transform (Cochran et al. 1967), whose results come in order, with factors 4, 5,
/// 3 and 2; any other prime factor p costs O(n p). Two real signals of like size are transformed for the price of one
/// as real and imaginary part: with Z = A + j B, A_k = (Z_k + Z*_{n−k})/2 and B_k = (Z_k − Z*_{n−k})/(2j).
class ComplexTransform {
 public:
  /// @param length  ≥ 1; `fast_length_above` and `fast_length_below` name those of factors 2, 3 and 5 alone
  explicit ComplexTransform(Index length);

  [[nodiscard]] Index length() const { return length_; }

  /// The signal before `run`, its transform after it. Filling and reading them exchanged gives the inverse, times n.
  [[nodiscard]] Vector& real() { return real_; }
  [[nodiscard]] Vector& imaginary() { return imaginary_; }
  void run();

 private:
  friend struct TransformLoops;
  std::shared_ptr<const struct TransformPlan> plan_;  // shared by transforms of one length
  Vector real_, imaginary_, other_real_, other_imaginary_;
  Index length_;
};

}  // namespace mbk::dsp
