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

/// AᵀA of a matrix whose rows come block by block.
class GramSum {
 public:
  explicit GramSum(Index columns);
  /// @param block rows×columns
  void add(const MatrixPart& block);
  [[nodiscard]] Matrix gram() const;

 private:
  Matrix sums_;  ///< without what is below the diagonal
};

/// AᵀB.
[[nodiscard]] Matrix products_of(const MatrixPart& A, const MatrixPart& B);

/// Zᵀ(Y − Z θ), p×q, in one pass and without the residuals in memory.   @param theta p×q
[[nodiscard]] Matrix projected_residuals(const MatrixPart& Z, const MatrixPart& Y, const Matrix& theta);

/// Y − [Z …] θ, N×q.   @param Z side by side, p columns in all    @param theta p×q
[[nodiscard]] Matrix residuals_of(const std::vector<MatrixPart>& Z, const MatrixPart& Y, const Matrix& theta);

/// Σ_t e_t e_{t+l} for l = first … first + count − 1, each over all pairs that there are.
/// @param first ≥ 0; first + count ≤ N
[[nodiscard]] Vector lagged_products(const Eigen::Ref<const Vector>& e, Index first, Index count);

}  // namespace mbk::numeric
