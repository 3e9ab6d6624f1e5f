#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/least_squares.h"

/// Regression on the past and future of signals, y_t = Σ_l h_l u_{t−l} + e_t, with coloured e.
namespace mbk::explore {

using numeric::RowRange;

[[nodiscard]] Index row_count(const std::vector<RowRange>& ranges);

/// The rows of some ranges under each other.
[[nodiscard]] Matrix rows_of(const Matrix& all, const std::vector<RowRange>& ranges);

/// Those rows of the ranges that have `before` rows of their piece before them and `after` behind them.
/// @param pieces rows without a break; each range lies in one of them
[[nodiscard]] std::vector<RowRange> rows_inside(const std::vector<RowRange>& ranges,
                                                const std::vector<RowRange>& pieces, Index before, Index after);

/// u_k[t − l] of every row t of the ranges; lags l = first … last of column 0, then those of column 1, …
/// @param u N×m    @returns rows×(m·(last − first + 1))
[[nodiscard]] Matrix lagged(const Matrix& u, Index first, Index last, const std::vector<RowRange>& ranges);

/// Each column less its mean.
[[nodiscard]] Matrix centred(const Matrix& columns);

/// Orthonormal directions in which columns vary, those of most variance first, down to singular values of
/// `threshold` times the largest.
/// @param columns N×p, centred    @returns p×r
[[nodiscard]] Matrix principal_directions(const Matrix& columns, double threshold = 1e-6);

/// The same from the products of the columns, p×p.
[[nodiscard]] Matrix principal_directions_of_products(const Matrix& products, double threshold = 1e-6);

/// Parts of equal numbers of consecutive rows; a part may reach over several ranges.
[[nodiscard]] std::vector<std::vector<RowRange>> folds_of(const std::vector<RowRange>& ranges, Index folds);

/// Signals that enter a regression with lags first … last.
struct LaggedSignals {
  Matrix u;  ///< N×m
  Index first = 0, last = 0;
  [[nodiscard]] Index lags() const { return last - first + 1; }
  [[nodiscard]] Index columns() const { return u.cols() * lags(); }  ///< in the order of lagged()
};

/// lagged(a)ᵀ lagged(b) of the rows of the ranges, without those columns: with P(i, j) = Σ_t a[t − i] b[t − j] over
/// rows s … e − 1,
///   P(i + 1, j + 1) = P(i, j) + a[s − 1 − i] b[s − 1 − j] − a[e − 1 − i] b[e − 1 − j]
[[nodiscard]] Matrix lagged_products(const LaggedSignals& a, const LaggedSignals& b,
                                     const std::vector<RowRange>& ranges);

/// Second moments of the rows of one fold.
struct Moments {
  Matrix ZZ;  ///< p×p, ZᵀZ
  Matrix ZY;  ///< p×q, ZᵀY
  Vector YY;  ///< q, of the columns of Y
  Index rows = 0;
};

/// Moments of the columns [lagged(signals₁) lagged(signals₂) …] and of Y, each column less its mean over all folds.
/// @param Y  as many rows as the signals, ×q
[[nodiscard]] std::vector<Moments> lagged_moments(const std::vector<LaggedSignals>& signals, const Matrix& Y,
                                                  const std::vector<std::vector<RowRange>>& folds);

/// Moments of those columns, in that order.
[[nodiscard]] std::vector<Moments> of_columns(const std::vector<Moments>& folds, const std::vector<Index>& columns);

/// Moments of the columns [Z₁ V, Z₂], Z₁ being as many first columns of Z as V has rows.
[[nodiscard]] std::vector<Moments> in_directions(const std::vector<Moments>& folds, const Matrix& V);

/// Mean squared errors of prediction by the first r of p columns, r = base … p, each fold of consecutive rows
/// predicted by the fit to the others; of several outputs, the mean of their errors over their variances. Columns and
/// outputs are centred over all folds, the columns can be distinguished.
/// @returns folds×(p − base + 1)
[[nodiscard]] Matrix cross_validated_errors(const std::vector<Moments>& folds, Index base);

/// The same from the rows themselves.
/// @param Z N×p, centred    @param Y N×q, centred
[[nodiscard]] Matrix cross_validated_errors(const Matrix& Z, const Matrix& Y, Index base, Index folds);

/// Coefficients of y = Z θ + e with instruments R, and their covariance where e is an autoregression that is
/// independent of R:
///   θ = (RᵀZ)⁻¹Rᵀy,   V = A RᵀΣR Aᵀ,   A = (RᵀZ)⁻¹
/// with Σ the covariance of the autoregression fitted to the residual, N/(N − p) times larger for what the fit took.
struct LaggedFit {
  Matrix coefficients;             ///< p×q
  std::vector<Matrix> covariance;  ///< q of p×p
  Matrix residual;                 ///< N×q
  std::vector<Vector> noise;       ///< q, 1, c₁ … of the autoregressions
};

/// @param Z N×p, R N×p, Y N×q, centred: the rows of `ranges` under each other
[[nodiscard]] LaggedFit fit_lagged(const Matrix& Z, const Matrix& R, const Matrix& Y,
                                   const std::vector<RowRange>& ranges);

/// e_t + c₁ e_{t−1} + … of every column; the first rows of each range are lost.
/// @param columns rows of `ranges` under each other
[[nodiscard]] Matrix whitened(const Matrix& columns, const Vector& filter, const std::vector<RowRange>& ranges);

/// Lags of each signal summed over groups of `wide`; lags left over at the end are dropped.
/// @param lagged  rows×(m·lags), as lagged() gives them    @returns rows×(m·⌊lags/wide⌋)
[[nodiscard]] Matrix summed_lags(const Matrix& lagged, Index lags, Index wide);

/// Whether errors are less than other ones, fold by fold, by two standard errors of their difference.
[[nodiscard]] bool predicts_better(const Vector& errors, const Vector& others);

/// "p = 0.03", "p < 1e-12".
[[nodiscard]] std::string chance_text(double p);

/// Residual sums of squares of y by the first r columns of Z, r = 0 … p.
/// @param Z N×p    @param y N    @returns p + 1
[[nodiscard]] Vector nested_squares(const Matrix& Z, const Vector& y);

/// Chance of the columns behind the first `base` to explain as much of Y as they do where they have no part in it: F
/// test of rows whitened by the autoregression of what all columns leave; the least of the outputs, Bonferroni.
/// @param Z N×p, Y N×q, centred: the rows of `ranges` under each other
[[nodiscard]] double chance_of_no_part(const Matrix& Z, Index base, const Matrix& Y,
                                       const std::vector<RowRange>& ranges);

/// How much of the variance of y a prediction accounts for, and how sure that is.
struct AccountedFor {
  double percent = 0;     ///< 100 (1 − var e/var y), Dyck 2013, eq. 3.10
  double half_width = 0;  ///< of its 95 % interval
  double rmse = 0;        ///< of e less its mean
};

/// VAF with its interval by the delta method: the influence of a row is −100 (e² − (1 − VAF) y²)/var y, whose
/// long-run variance (Newey & West 1987, lags of half a second, widened by Kiefer & Vogelsang 2005) is that of VAF.
/// @param y, e  rows of `ranges` under each other; their means are removed
[[nodiscard]] AccountedFor accounted_for(const Vector& y, const Vector& e, const std::vector<RowRange>& ranges,
                                         double sample_time);

}  // namespace mbk::explore
