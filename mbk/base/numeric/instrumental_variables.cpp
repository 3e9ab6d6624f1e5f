#include "mbk/base/numeric/instrumental_variables.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <limits>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {
namespace {

/// What makes the columns unit length; 0 columns stay.
Vector scaling(const Matrix& columns) {
  const Vector length = columns.colwise().norm();
  return (length.array() > 0.0).select(length.cwiseInverse(), 1.0);
}

Result<void> check(const Matrix& Z, const Matrix& R, const Matrix& Y) {
  if (Z.rows() != R.rows() || Z.rows() != Y.rows() || Z.cols() != R.cols()) {
    return bad_usage(fmt::format("regressors {}×{}, instruments {}×{} and outputs {}×{} do not go together", Z.rows(),
                                 Z.cols(), R.rows(), R.cols(), Y.rows(), Y.cols()));
  }
  if (Z.rows() < Z.cols()) {
    return bad_data(fmt::format("{} samples are too few for {} coefficients", Z.rows(), Z.cols()), "record longer");
  }
  if (!Z.allFinite() || !R.allFinite() || !Y.allFinite()) return bad_data("a value of the regression is not finite");
  return {};
}

}  // namespace

Result<InstrumentalFit> fit_instrumental_variables(const Matrix& Z, const Matrix& R, const Matrix& Y, const Matrix& S) {
  if (auto ok = check(Z, R, Y); !ok) return tl::unexpected(ok.error());
  const Index p = Z.cols(), q = Y.cols();
  InstrumentalFit fit;
  fit.structure = S.size() > 0 ? S : Matrix(Matrix::Identity(p * q, p * q));
  const Vector unit_Z = scaling(Z), unit_R = scaling(R);
  const Matrix cross = unit_R.asDiagonal() * (R.transpose() * Z) * unit_Z.asDiagonal();
  const Matrix right = unit_R.asDiagonal() * (R.transpose() * Y);
  const double threshold = static_cast<double>(p) * std::numeric_limits<double>::epsilon() * 1e3;
  fit.rank = static_cast<int>(PivotedQr(cross, threshold).rank());
  const Index k = fit.structure.cols();
  if (fit.rank < p) {
    fit.coefficients = Matrix::Constant(p, q, kNaN);
    fit.free = Vector::Constant(k, kNaN);
    fit.inverse = Matrix::Constant(k, k, kNaN);
    return fit;
  }
  // Scaled: θ = Λ_Z θ', and the structure is imposed on θ.
  Matrix stacked = Matrix::Zero(p * q, p * q);
  for (Index j = 0; j < q; ++j) {
    stacked.block(j * p, j * p, p, p) = cross * unit_Z.cwiseInverse().asDiagonal();
  }
  Matrix weight = Matrix::Zero(p * q, p * q);  // back to RᵀZ, so that A is that of the unscaled scores
  for (Index j = 0; j < q; ++j) weight.diagonal().segment(j * p, p) = unit_R.cwiseInverse();
  const Matrix system = fit.structure.transpose() * weight * stacked * fit.structure;
  const Vector row_scale = system.rowwise().norm().cwiseInverse(),
               column_scale = system.colwise().norm().cwiseInverse();
  const FullyPivotedLu lu(row_scale.asDiagonal() * system * column_scale.asDiagonal());
  fit.inverse = column_scale.asDiagonal() * lu.inverse() * row_scale.asDiagonal();
  const Vector target = fit.structure.transpose() * weight * Vector(right.reshaped());
  fit.free = column_scale.asDiagonal() * lu.solve(row_scale.asDiagonal() * target);
  fit.coefficients = Vector(fit.structure * fit.free).reshaped(p, q);
  return fit;
}

Matrix newey_west_covariance(const InstrumentalFit& fit, const Matrix& R, const Matrix& residuals,
                             const std::vector<RowRange>& ranges, Index lags) {
  const Matrix omega = long_run_covariance(fit.free.size(), ranges, lags, [&](const RowRange& range) {
    return regression_scores(R, residuals, fit.structure, range);
  });
  return fit.inverse * omega * fit.inverse.transpose();
}

Vector first_stage_strength(Matrix Z, Matrix R, const std::vector<RowRange>& ranges, Index lags) {
  // In place: of a long recording these are the largest matrices there are.
  const Index m = Z.cols() - 1, excluded = R.cols() - 1;
  const auto freedom = static_cast<double>(excluded - m + 1);
  R *= scaling(R).asDiagonal();
  Z *= scaling(Z).asDiagonal();
  const Matrix &scaled_R = R, &scaled_Z = Z;
  const PivotedQr gram(scaled_R.transpose() * scaled_R);
  if (gram.rank() < R.cols()) return Vector::Zero(m);
  const Matrix inverse = gram.inverse();
  const Matrix first = inverse * (scaled_R.transpose() * scaled_Z);  // R first ≈ Z
  const Matrix predicted = scaled_R * first;
  Vector strength = Vector::Zero(m);
  for (Index j = 0; j < m; ++j) {
    std::vector<Index> others;
    for (Index i = 0; i <= m; ++i) {
      if (i != j) others.push_back(i);
    }
    Matrix E = predicted(Eigen::all, others);
    const PivotedQr second(E.transpose() * E);
    if (second.rank() < m) continue;
    const Vector by_others = second.solve(E.transpose() * scaled_Z.col(j));
    E = scaled_Z(Eigen::all, others);
    const Vector own = scaled_Z.col(j) - E * by_others;
    E.resize(0, 0);
    const Vector coefficients = inverse * (scaled_R.transpose() * own);
    const Matrix left = own - scaled_R * coefficients;
    const Matrix omega = long_run_covariance(R.cols(), ranges, lags, [&](const RowRange& range) {
      return regression_scores(scaled_R, left, Matrix::Identity(R.cols(), R.cols()), range);
    });
    const Matrix V = (inverse * omega * inverse).topLeftCorner(excluded, excluded);
    const Vector slope = coefficients.head(excluded);
    const double wald = slope.dot(CompleteOrthogonal(V).solve(slope));
    strength[j] = std::isfinite(wald) && wald > 0.0 ? wald / freedom : 0.0;
  }
  return strength;
}

}  // namespace mbk::numeric
