#pragma once

#include <Eigen/Core>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::impedance {

/// How far two matrices are apart, and in what direction of motion most and least.
struct Width {
  double distance = 0;  ///< d ≥ 0
  /// λᵢ of A⁻¹B, rising: how many times B is A, in the directions of motion in which that is least and most; n of them.
  Vector ratios;
  Matrix directions;  ///< n×n, unit columns: those directions
  /// dd and d ln λᵢ by A and B as measured, n² numbers each row by row: 1×n² and n×n². Where d = 0 the distance has a
  /// corner and `by_first` is NaN.
  Eigen::RowVectorXd by_first, by_second;
  Matrix ratios_by_first, ratios_by_second;
};

/// Affine-invariant distance of the symmetric parts A and B of two matrices,
///   d = √(Σ ln² λᵢ(A⁻¹B)),  B vᵢ = λᵢ A vᵢ,  vᵢᵀ A vᵢ = 1                         (Rao 1945; Förstner & Moonen 1999)
///   d ln λᵢ = vᵢᵀ dB vᵢ/λᵢ − vᵢᵀ dA vᵢ,  dd = Σ ln λᵢ d ln λᵢ / d
/// It is a metric, and the same in whatever units and axes the motion is described: for stiffness K at the hand and at
/// the joints alike. Where λᵢ repeat, each by itself has no derivative; d has one all the same.
/// @param first, second  n×n, the same n of 1 or 2
/// @fails  data: shapes differ; a value is not finite; a symmetric part is not positive definite (which, and its
///         smallest eigenvalue, are named).
[[nodiscard]] Result<Width> impedance_width(const Matrix& first, const Matrix& second);

}  // namespace mbk::impedance
