#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

/// @file
/// Dot products of long columns, in tiles that fill the registers. The inner loops are compiled for several processors;
/// which runs is decided where the program runs.
namespace mbk::numeric {

using Columns = Eigen::Ref<const Matrix>;

/// [A B …]ᵀ[A B …] of columns of equal length.
[[nodiscard]] Matrix gram_of(const std::vector<Columns>& side_by_side);

/// AᵀB.
[[nodiscard]] Matrix products_of(const Columns& A, const Columns& B);

/// Zᵀ(Y − Z θ), p×q, in one pass and without the residuals in memory.   @param theta p×q
[[nodiscard]] Matrix projected_residuals(const Columns& Z, const Columns& Y, const Matrix& theta);

}  // namespace mbk::numeric
