#pragma once

#include <Eigen/Core>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::dsp {

/// Discrete Fourier transform X_k = Σ_i x_i e^(−2πj i k/n), k = 0 … ⌊n/2⌋, at any length in O(n log n): where n has
/// other factors than 2, 3 and 5, as a convolution with a chirp (Bluestein 1970, i k = (i² + k² − (k − i)²)/2).
/// @param signal  not empty
[[nodiscard]] Eigen::VectorXcd fourier_transform(const Vector& signal);

/// The same of each column, (⌊n/2⌋ + 1)×signals. Two columns pass as one, so that rounding of the larger one is left in
/// the smaller: signals of like size belong together.
/// @param signals  n×signals, n ≥ 1
[[nodiscard]] Eigen::MatrixXcd fourier_transforms(const Matrix& signals);

}  // namespace mbk::dsp
