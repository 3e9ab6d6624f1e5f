#include "mbk/base/numeric/instrumental_variables.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <limits>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/long_run_covariances.h"

namespace mbk::numeric {
namespace {

/// What makes columns unit length, whose squares are given; 0 columns stay.
Vector scaling(const Vector& squares) {
  return (squares.array() > 0.0).select(squares.cwiseSqrt().cwiseInverse(), 1.0);
}

}  // namespace

Result<InstrumentalFit> fit_instrumental_variables(const MatrixPart& Z, const MatrixPart& R, const MatrixPart& Y,
                                                   const Matrix& S) {
  if (Z.rows() != R.rows() || Z.rows() != Y.rows() || Z.cols() != R.cols()) {
    return bad_usage(fmt::format("regressors {}×{}, instruments {}×{} and outputs {}×{} have inconsistent sizes",
                                 Z.rows(), Z.cols(), R.rows(), R.cols(), Y.rows(), Y.cols()));
  }
  return fit_instrumental_variables(gram_of({R, Z, Y}), Z.cols(), Z.rows(), S);
}

Result<InstrumentalFit> fit_instrumental_variables(const Matrix& gram, Index p, Index N, const Matrix& S) {
  const Index q = gram.cols() - 2 * p;
  if (p < 1 || q < 1 || gram.rows() != gram.cols()) {
    return bad_usage(fmt::format("products {}×{} do not fit {} instruments, as many regressors and the outputs",
                                 gram.rows(), gram.cols(), p));
  }
  if (N < p) return bad_data(fmt::format("{} samples are too few for {} coefficients", N, p), "record longer");
  InstrumentalFit fit;
  fit.structure = S.size() > 0 ? S : Matrix(Matrix::Identity(p * q, p * q));
  const Vector unit_R = scaling(gram.diagonal().head(p)), unit_Z = scaling(gram.diagonal().segment(p, p));
  const Matrix cross = unit_R.asDiagonal() * gram.block(0, p, p, p) * unit_Z.asDiagonal();
  const Matrix right = unit_R.asDiagonal() * gram.topRightCorner(p, q);
  if (!cross.allFinite() || !right.allFinite()) {  // as every value that is not finite makes them
    return bad_data("a value of the regression is not finite, or too large to be squared");
  }
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

Vector first_stage_strength(const MatrixPart& Z, const MatrixPart& R, const std::vector<RowRange>& ranges, Index lags,
                            const Matrix& given) {
  const Index m = Z.cols() - 1, excluded = R.cols() - 1;
  const auto freedom = static_cast<double>(excluded - m + 1);
  // All that is needed but the residuals follows from products of columns, each scaled to unit length.
  const Matrix gram = given.size() > 0 ? given : gram_of({R, Z});
  const Vector unit = scaling(gram.diagonal());
  const Vector unit_R = unit.head(R.cols()), unit_Z = unit.tail(Z.cols());
  const Matrix RR = unit_R.asDiagonal() * gram.topLeftCorner(R.cols(), R.cols()) * unit_R.asDiagonal();
  const Matrix RZ = unit_R.asDiagonal() * gram.topRightCorner(R.cols(), Z.cols()) * unit_Z.asDiagonal();
  const PivotedQr instruments(RR);
  if (instruments.rank() < R.cols()) return Vector::Zero(m);
  const Matrix inverse = instruments.inverse();
  const Matrix predicted = RZ.transpose() * inverse * RZ;  // products of R (RᵀR)⁻¹RᵀZ
  constexpr double kDependent = 1e-11;                     // of products that were added up
  // What of each regressor the others do not explain, and the instruments' part in that.
  struct Conditional {
    Index regressor;
    Vector coefficients;  // of the instruments
  };
  std::vector<Conditional> all;
  Matrix taken(Z.cols() + R.cols(), m);  // of [Z R], from nothing to what is left of each
  for (Index j = 0; j < m; ++j) {
    std::vector<Index> others;
    for (Index i = 0; i <= m; ++i) {
      if (i != j) others.push_back(i);
    }
    const PivotedQr second(predicted(others, others), kDependent);
    if (second.rank() < m) continue;
    Vector own = Vector::Unit(Z.cols(), j);  // z_j without what the others explain of it
    own(others) = -second.solve(predicted(others, j));
    Conditional one{j, inverse * (RZ * own)};
    taken.col(std::ssize(all)) << -unit_Z.cwiseProduct(own), unit_R.cwiseProduct(one.coefficients);
    all.push_back(std::move(one));
  }
  Vector strength = Vector::Zero(m);
  if (all.empty()) return strength;
  const Index kinds = std::ssize(all);
  taken.conservativeResize(Eigen::NoChange, kinds);
  // Scores of the excluded instruments' coefficients, A r_t e_t with A of (RᵀR)⁻¹: their Ω is the covariance.
  const Matrix to_coefficients = -(unit_R.asDiagonal() * inverse.leftCols(excluded));
  Matrix left, weighted, nothing;
  const std::vector<Matrix> covariances =
      long_run_covariances(kinds, excluded, ranges, lags, [&](const RowRange& range) {
        const Index count = range.size();
        const auto rows = R.middleRows(range.begin, count);
        if (nothing.rows() < count) nothing = Matrix::Zero(count, excluded);
        left = residuals_of({Z.middleRows(range.begin, count), rows}, nothing.topLeftCorner(count, kinds), taken);
        weighted = residuals_of({rows}, nothing.topRows(count), to_coefficients);
        ScoreProducts products;
        for (Index kind = 0; kind < kinds; ++kind) {
          for (Index i = 0; i < excluded; ++i) {
            products.left.push_back(weighted.col(i).data());
            products.right.push_back(left.col(kind).data());
          }
        }
        return products;
      });
  for (std::size_t kind = 0; kind < all.size(); ++kind) {
    const Vector slope = all[kind].coefficients.head(excluded);
    const double wald = slope.dot(CompleteOrthogonal(covariances[kind]).solve(slope));
    strength[all[kind].regressor] = std::isfinite(wald) && wald > 0.0 ? wald / freedom : 0.0;
  }
  return strength;
}

}  // namespace mbk::numeric
