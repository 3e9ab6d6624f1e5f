#include "mbk/numeric/least_squares.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <limits>

namespace mbk::numeric {

Result<LinearFit> fit_least_squares(const Matrix& Z, const Matrix& Y, const Matrix& S) {
  const Index n = Z.rows(), p = Z.cols(), q = Y.cols();
  if (Y.rows() != n || (S.size() > 0 && S.rows() != p * q)) {
    return bad_data(
        fmt::format("regression shapes differ: Z is {}×{}, Y {}×{}, S {}×{}", n, p, Y.rows(), q, S.rows(), S.cols()));
  }
  if (n < p) return bad_data(fmt::format("{} samples cannot determine {} parameters per axis", n, p), "record longer");
  Vector length(p);
  for (Index j = 0; j < p; ++j) {
    const double norm = Z.col(j).norm();
    length[j] = norm > 0.0 ? norm : 1.0;
  }
  Matrix work(n, p + q);
  work << Z * length.cwiseInverse().asDiagonal(), Y;
  if (!work.allFinite()) {
    Index bad = 0;
    while (work.row(bad).allFinite()) ++bad;
    return bad_data(fmt::format("a value is not finite in row {} of the regression", bad));
  }
  const Eigen::HouseholderQR<Eigen::Ref<Matrix>> qr(work);
  Matrix R = Matrix::Zero(p, p);
  R.triangularView<Eigen::Upper>() = work.topLeftCorner(p, p).triangularView<Eigen::Upper>();
  const Matrix Qty = work.topRightCorner(p, q);

  LinearFit fit;
  const Eigen::JacobiSVD<Matrix> svd(R);
  const Vector& singular = svd.singularValues();
  const double smallest_counted = static_cast<double>(p) * std::numeric_limits<double>::epsilon() * singular[0];
  fit.rank = static_cast<int>((singular.array() > smallest_counted).count());
  fit.condition = fit.rank < p ? std::numeric_limits<double>::infinity() : singular[0] / singular[p - 1];

  fit.structure = S.size() > 0 ? S : Matrix::Identity(p * q, p * q);
  // (I ⊗ R Λ) S φ = vec(Qᵀ Y), with Λ the column lengths.
  const Matrix RL = R * length.asDiagonal();
  Matrix small(p * q, fit.structure.cols());
  for (Index j = 0; j < q; ++j) small.middleRows(j * p, p) = RL * fit.structure.middleRows(j * p, p);
  Vector scale = small.colwise().norm();
  scale = (scale.array() > 0.0).select(scale, 1.0);
  small *= scale.cwiseInverse().asDiagonal();
  const Eigen::CompleteOrthogonalDecomposition<Matrix> solver(small);
  fit.free = scale.cwiseInverse().asDiagonal() * solver.solve(Vector(Qty.reshaped()));
  const Vector theta = fit.structure * fit.free;
  fit.coefficients = theta.reshaped(p, q);
  const Matrix inverse = scale.cwiseInverse().asDiagonal() * solver.pseudoInverse();
  fit.inverse_gram = inverse * inverse.transpose();
  return fit;
}

Matrix newey_west_covariance(const LinearFit& fit, const Matrix& Z, const Matrix& residuals,
                             const std::vector<RowRange>& ranges, Index lags) {
  const Index p = Z.cols(), q = residuals.cols(), k = fit.free.size();
  const bool tied = fit.structure.rows() != k || !fit.structure.isIdentity(0.0);
  Matrix omega = Matrix::Zero(k, k);
  constexpr Index kBlock = 512;  // window sums are collected in blocks and added to Ω by one matrix product
  Matrix block(k, kBlock);
  for (const RowRange& range : ranges) {
    const Index n = range.size();
    Matrix full(p * q, n);
    for (Index j = 0; j < q; ++j) {
      full.middleRows(j * p, p) =
          (Z.middleRows(range.begin, n).array().colwise() * residuals.col(j).segment(range.begin, n).array())
              .matrix()
              .transpose();
    }
    const Matrix scores = tied ? Matrix(fit.structure.transpose() * full) : std::move(full);
    Vector sum = Vector::Zero(k);
    Index filled = 0;
    for (Index t = 0; t < n + lags; ++t) {  // the window [t − lags, t], clipped to the range
      if (t < n) sum += scores.col(t);
      if (t - lags - 1 >= 0) sum -= scores.col(t - lags - 1);
      block.col(filled++) = sum;
      if (filled == kBlock || t + 1 == n + lags) {
        omega.selfadjointView<Eigen::Lower>().rankUpdate(block.leftCols(filled));
        filled = 0;
      }
    }
  }
  omega /= static_cast<double>(lags + 1);
  return fit.inverse_gram * omega.selfadjointView<Eigen::Lower>() * fit.inverse_gram;
}

double newey_west_widening(double b) {
  const double within = std::clamp(b, 0.0, 1.0);
  return 1.0 + within * (2.9694 + within * (0.4160 - within * 0.5324)) / 1.9600;
}

}  // namespace mbk::numeric
