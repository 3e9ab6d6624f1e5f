#pragma once

#include <limits>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/measure/explore/lagged_regression.h"
#include "mbk/measure/explore/spline_basis.h"

/// Regression whose coefficients are functions of a variable, y_t = Σ_k θ_k(s_t) z_tk + e_t, θ_k(s) = Σ_j θ_jk φ_j(s),
/// with coloured e.
namespace mbk::explore {

/// Rows under each other, those of the ranges and no others.
struct VaryingRows {
  Matrix Z;                      ///< N×p; the last column is 1
  Matrix R;                      ///< N×p, instruments; Z itself where there are none
  Matrix Y;                      ///< N×q
  Vector s;                      ///< N, in [0, 1]
  std::vector<RowRange> ranges;  ///< without a break in time
};

/// Which coefficients are functions of the variable: those of the last `varying` columns on a basis; the others are
/// constants.
struct VaryingModel {
  SplineBasis basis;
  Index varying = 0;  ///< 1 … p; of one function nothing varies
};

/// φ_j(s_t) z_tk in column j p + k.
[[nodiscard]] Matrix varying_columns(const Matrix& Z, const SplineBasis& basis, const Vector& s);

/// The noise of each output as an autoregression of the residual of a least-squares fit, q of 1, c₁ …
[[nodiscard]] std::vector<Vector> noise_of(const VaryingRows& rows, const VaryingModel& model);

/// A model and how likely it makes the data.
struct ChosenSplines {
  VaryingModel model;
  double bic = 0;           ///< Σ_outputs N log(RSS/N) + parameters · log N, of whitened rows
  double bic_constant = 0;  ///< where no coefficient varies
  double bic_last = 0;      ///< the least where only that of the last column does
  double bic_refused = std::numeric_limits<double>::infinity();  ///< the least of bases that the motion does not tell
};

/// The splines of degree 1 or 3 of least BIC. Rows are whitened by the noise first, so that each counts as one sample.
/// Candidates are constants, straight lines, parabolas, cubics, and splines with 1 to 23 knots at equal distances, for
/// each of several numbers of columns that vary; the best of them then gains and loses knots on a grid of 48 cells as
/// long as BIC falls, each such knot counting as one parameter more. A basis is taken only where the rows of each of
/// its functions move the columns that vary first (without the constant) in all directions: λ_min(G⁻¹ Σ φ_j z zᵀ) ≥
/// 0.03 Σ φ_j, with G the mean of z zᵀ over all rows.
/// @param varying  numbers of last columns that may vary together, ascending
[[nodiscard]] ChosenSplines choose_splines(const VaryingRows& rows, const std::vector<Vector>& noise,
                                           const std::vector<Index>& varying);

/// θ by instruments in whitened rows, θ = (RᵀZ)⁻¹Rᵀy, with the covariance of White (1980): together prewhitened ones
/// that hold for coloured noise whose strength changes (Andrews & Monahan 1992).
struct VaryingFit {
  Matrix coefficients;             ///< J p × q, j p + k; those that do not vary are the same for all j
  std::vector<Matrix> covariance;  ///< q of J p × J p
  double freedom = 0;              ///< rows less coefficients
};

[[nodiscard]] VaryingFit fit_varying(const VaryingRows& rows, const VaryingModel& model,
                                     const std::vector<Vector>& noise);

}  // namespace mbk::explore
