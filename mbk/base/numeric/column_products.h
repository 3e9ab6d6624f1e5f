#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

/// @file
/// Dot products of long columns, in tiles that fill the registers. The inner loops are compiled for several processors;
/// which runs is decided where the program runs.
namespace mbk::numeric {

using MatrixPart = Eigen::Ref<const Matrix>;

/// [A B …]ᵀ[A B …] of columns of equal length.
[[nodiscard]] Matrix gram_of(const std::vector<MatrixPart>& side_by_side);

/// AᵀB.
[[nodiscard]] Matrix products_of(const MatrixPart& A, const MatrixPart& B);

/// Zᵀ(Y − Z θ), p×q, in one pass and without the residuals in memory.   @param theta p×q
[[nodiscard]] Matrix projected_residuals(const MatrixPart& Z, const MatrixPart& Y, const Matrix& theta);

}  // namespace mbk::numeric
