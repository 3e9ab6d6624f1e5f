#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/numeric/least_squares.h"

namespace mbk::numeric {

/// Linear regression by instruments, θ = (RᵀZ)⁻¹RᵀY (Söderström & Stoica 1983), tied by a structure as in LinearFit:
/// φ = (Sᵀ(I ⊗ RᵀZ)S)⁻¹ Sᵀ vec(RᵀY).
struct InstrumentalFit {
  Matrix coefficients;  ///< p×q
  Vector free;          ///< φ, k
  Matrix structure;     ///< S, pq×k
  Matrix inverse;       ///< A = (Sᵀ(I ⊗ RᵀZ)S)⁻¹, k×k, not symmetric
  int rank = 0;         ///< of RᵀZ, both scaled to unit length; < p where the instruments do not identify the terms
};

/// @param Z N×p    @param R N×p    @param Y N×q    @param S pq×k, full column rank; empty = nothing tied
/// @returns the fit; where rank < p the coefficients are NaN.   @fails N < p; shapes differ; a value is not finite.
[[nodiscard]] Result<InstrumentalFit> fit_instrumental_variables(const MatrixPart& Z, const MatrixPart& R,
                                                                 const MatrixPart& Y, const Matrix& S = {});

/// The same from products of columns.
/// @param gram [R Z Y]ᵀ[R Z Y], (2p + q)×(2p + q)    @param p regressors    @param N samples behind it
[[nodiscard]] Result<InstrumentalFit> fit_instrumental_variables(const Matrix& gram, Index p, Index N,
                                                                 const Matrix& S = {});

/// Covariance of φ that holds for coloured and correlated residuals: A Ω Aᵀ, Ω the long-run covariance of the scores of
/// R (least_squares.h).
[[nodiscard]] Matrix newey_west_covariance(const InstrumentalFit& fit, const Matrix& R, const Matrix& residuals,
                                           const std::vector<RowRange>& ranges, Index lags);

/// How strongly the instruments hold each regressor: the conditional first-stage F statistic (Sanderson & Windmeijer
/// 2016) in the form that holds for coloured residuals. Of regressor j what the other regressors, as the instruments
/// predict them, do not explain is regressed on the instruments; F is the Wald statistic of that over its degrees of
/// freedom, excluded instruments − regressors + 1. Below 10 the instruments are weak: the estimate is then drawn
/// towards least squares and its intervals mean little.
/// @param Z N×p, R N×r with r ≥ p; the last column of both is the constant
/// @param gram [R Z]ᵀ[R Z], where it is there already; empty otherwise
/// @returns p − 1 statistics; 0 where the instruments cannot tell the regressor from the others
[[nodiscard]] Vector first_stage_strength(const MatrixPart& Z, const MatrixPart& R, const std::vector<RowRange>& ranges,
                                          Index lags, const Matrix& gram = {});

}  // namespace mbk::numeric
