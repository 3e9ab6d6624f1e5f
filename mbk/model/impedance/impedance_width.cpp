#include "mbk/model/impedance/impedance_width.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk::impedance {
namespace {

Result<Matrix> positive_definite(const Matrix& Z, const char* which) {
  if (!Z.allFinite()) return bad_data(fmt::format("the {} matrix is unknown", which));
  const Matrix symmetric = symmetric_part(Z);
  const Vector eigenvalues = numeric::symmetric_eigenvalues(symmetric);
  const double smallest = eigenvalues.minCoeff(), largest = eigenvalues.maxCoeff();
  constexpr double kSingular = 1e-12;  // of the largest: beside that, rounding decides the sign
  if (smallest > kSingular * std::abs(largest)) return symmetric;
  return bad_data(
      fmt::format("the {} matrix is not positive definite: its smallest eigenvalue is {:.3g}", which, smallest));
}

/// vᵀ dZ v by the numbers of Z row by row, 1×n².
Eigen::RowVectorXd along(const Vector& v) {
  const Matrix outer = v * v.transpose();
  return outer.reshaped().transpose();
}

}  // namespace

Result<Width> impedance_width(const Matrix& first, const Matrix& second) {
  if (first.rows() != second.rows() || first.cols() != second.cols() || first.rows() != first.cols()) {
    return bad_data(fmt::format("matrices of {}×{} and {}×{} cannot be compared", first.rows(), first.cols(),
                                second.rows(), second.cols()));
  }
  const auto A = MBK_TRY(positive_definite(first, "first"));
  const auto B = MBK_TRY(positive_definite(second, "second"));
  const auto [values, vectors] = numeric::generalized_symmetric_eigen(B, A);
  const Index n = first.rows();
  Width width;
  width.ratios = values;
  width.directions = vectors.colwise().normalized();
  const Vector logarithms = width.ratios.array().log();
  width.distance = logarithms.norm();
  width.ratios_by_first.resize(n, n * n);
  width.ratios_by_second.resize(n, n * n);
  for (Index i = 0; i < n; ++i) {
    const Eigen::RowVectorXd change = along(vectors.col(i));
    width.ratios_by_first.row(i) = -change;
    width.ratios_by_second.row(i) = change / width.ratios[i];
  }
  const Vector weights = logarithms / width.distance;  // 0/0 at the corner
  width.by_first = weights.transpose() * width.ratios_by_first;
  width.by_second = weights.transpose() * width.ratios_by_second;
  return width;
}

}  // namespace mbk::impedance
