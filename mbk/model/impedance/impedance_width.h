#pragma once

#include <Eigen/Core>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::impedance {

/// Distance of two matrices, and the directions of motion of its extremes.
struct Width {
  double distance = 0;  ///< d ≥ 0
  /// λᵢ of A⁻¹B, increasing: the ratio of B to A in the directions of motion of its extremes; n of them.
  Vector ratios;
  Matrix directions;  ///< n×n, unit columns: those directions
  /// Derivatives of d and ln λᵢ by A and B as measured, n² numbers each row by row: 1×n² and n×n². At d = 0 the
  /// distance is not differentiable and `by_first` is NaN.
  Eigen::RowVectorXd by_first, by_second;
  Matrix ratios_by_first, ratios_by_second;
};

/// Affine-invariant distance of the symmetric parts A and B of two matrices,
///   d = √(Σ ln² λᵢ(A⁻¹B)),  B vᵢ = λᵢ A vᵢ,  vᵢᵀ A vᵢ = 1                         (Rao 1945; Förstner & Moonen 1999)
///   d ln λᵢ = vᵢᵀ dB vᵢ/λᵢ − vᵢᵀ dA vᵢ,  dd = Σ ln λᵢ d ln λᵢ / d
/// It is a metric that does not depend on the units and axes of the motion: it is equal for stiffness K at the hand and
/// at the joints. Where λᵢ are equal, they are not differentiable individually, but d is.
/// @param first, second  n×n, the same n of 1 or 2
/// @fails  data: shapes differ; a value is not finite; a symmetric part is not positive definite (the message gives
/// which one and its smallest eigenvalue).
[[nodiscard]] Result<Width> impedance_width(const Matrix& first, const Matrix& second);

}  // namespace mbk::impedance
