#pragma once

#include <functional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/numeric/column_products.h"

namespace mbk::numeric {

/// Rows [begin, end) that follow each other in time without a break.
struct RowRange {
  Index begin = 0, end = 0;
  [[nodiscard]] Index size() const { return end - begin; }
};

/// Linear regression of q outputs on the same p regressors, y_j = Zᵀθ_j + e_j, where the stacked coefficients
/// θ = [θ_1; …; θ_q] may be tied by a linear structure, θ = S φ.
struct LinearFit {
  Matrix coefficients;   ///< p×q, θ_j in column j
  Vector free;           ///< φ, k
  Matrix structure;      ///< S, pq×k; the identity where nothing is tied
  Matrix inverse_gram;   ///< (Sᵀ (I ⊗ ZᵀZ) S)⁻¹, k×k
  int rank = 0;          ///< of the regressors, each scaled to unit length; < p where they cannot be distinguished
  double condition = 0;  ///< largest over smallest singular value of the scaled regressors; ∞ where rank < p
};

/// Ordinary least squares, each column of Z scaled to unit length: by Cholesky with refinement up to a condition of
/// 1000, beyond it by one Householder QR of [Z | Y]. The structure is then imposed on the small triangle, so that tied
/// and free fits pass through the same code.
/// @param Z N×p    @param Y N×q    @param S pq×k, full column rank; empty = nothing tied
/// @returns the fit; where rank < p (singular values below p·ε of the largest) the coefficients are those of
/// smallest norm and must not be used.   @fails N < p; shapes differ; a value is not finite (first bad row named).
[[nodiscard]] Result<LinearFit> fit_least_squares(const MatrixPart& Z, const MatrixPart& Y, const Matrix& S = {});

/// Long-run covariance of scores, Ω = Σ_l (1 − |l|/(L + 1)) Σ_t s_t s_{t+l}ᵀ (Newey & West 1987). The weights are the
/// autocorrelation of a rectangle, so that Ω = Σ_t g_t g_tᵀ/(L + 1) with g the sums of s over L + 1 consecutive
/// samples: one pass, and positive semidefinite by construction. Products never cross a break.
/// @param k scores of a sample    @param lags L ≥ 0, samples
/// @param scores_of the scores of some rows of a range, n×k; asked for once for each row, in order
[[nodiscard]] Matrix long_run_covariance(Index k, const std::vector<RowRange>& ranges, Index lags,
                                         const std::function<Matrix(const RowRange&)>& scores_of);

/// s_t = Sᵀ(e_t ⊗ r_t) of the rows of a range, n×k.
/// @param R N×p, regressors or instruments    @param residuals N×q    @param structure S, pq×k
[[nodiscard]] Matrix regression_scores(const MatrixPart& R, const MatrixPart& residuals, const Matrix& structure,
                                       const RowRange& range);

/// Covariance of φ that holds for coloured and correlated residuals: V = A Ω A with A = inverse_gram and Ω the long-run
/// covariance of the scores of Z.
/// @param residuals N×q    @param ranges rows that count, in order    @param lags L ≥ 0, samples
[[nodiscard]] Matrix newey_west_covariance(const LinearFit& fit, const Matrix& Z, const Matrix& residuals,
                                           const std::vector<RowRange>& ranges, Index lags);

/// How much wider than ±1.96 standard errors of `newey_west_covariance` a 95 % interval is where the lags are a
/// fraction `b` = L/N of the data: (1.96 + 2.9694 b + 0.4160 b² − 0.5324 b³)/1.96 (Kiefer & Vogelsang 2005, table 1,
/// Bartlett).
[[nodiscard]] double newey_west_widening(double b);

/// How much wider standard errors are than the residuals of a fit make them, which have lost what the coefficients
/// took: √(n/(n − p)), n independent samples and p coefficients for each output. Samples that passed a low-pass are no
/// more independent than 2 f_c T of them. Not below 1; where n < 2 p it stays at √2, for so little holds no interval.
[[nodiscard]] double fitted_widening(double independent, double coefficients);

}  // namespace mbk::numeric
