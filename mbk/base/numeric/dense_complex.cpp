#include <Eigen/QR>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

namespace {

/// Each number a + b i as [a, −b; b, a], which is to real and imaginary parts in turn what A is to x. Its inverse is
/// that of A written so; it has each singular value, and of a Hermitian A each eigenvalue and each pivot, twice.
Matrix as_real(const Eigen::MatrixXcd& A) {
  Matrix real(2 * A.rows(), 2 * A.cols());
  for (Index j = 0; j < A.cols(); ++j) {
    for (Index i = 0; i < A.rows(); ++i) {
      const double a = A(i, j).real(), b = A(i, j).imag();
      real(2 * i, 2 * j) = real(2 * i + 1, 2 * j + 1) = a;
      real(2 * i + 1, 2 * j) = b;
      real(2 * i, 2 * j + 1) = -b;
    }
  }
  return real;
}

/// The same, with a diagonal that is real. Of its lower triangle nothing comes from the upper one of A.
Matrix hermitian_as_real(const Eigen::MatrixXcd& A) {
  Matrix real = as_real(A);
  for (Index i = 0; i < A.rows(); ++i) real(2 * i + 1, 2 * i) = 0.0;
  return real;
}

Vector every_second(const Vector& values) {
  return values(Eigen::seqN(0, values.size() / 2, 2));
}

}  // namespace

Vector hermitian_eigenvalues(const Eigen::MatrixXcd& A) {
  return every_second(symmetric_eigenvalues(hermitian_as_real(A)));
}

Vector complex_singular_values(const Eigen::MatrixXcd& A) {
  return every_second(singular_values(as_real(A)));
}

Eigen::MatrixXcd complex_inverse(const Eigen::MatrixXcd& A) {
  const Matrix real = inverse(as_real(A));
  Eigen::MatrixXcd result(A.cols(), A.rows());
  for (Index j = 0; j < result.cols(); ++j) {
    for (Index i = 0; i < result.rows(); ++i) result(i, j) = {real(2 * i, 2 * j), real(2 * i + 1, 2 * j)};
  }
  return result;
}

HermitianPivotedCholesky::HermitianPivotedCholesky(const Eigen::MatrixXcd& A) : as_real_(hermitian_as_real(A)) {}

/// Eigen takes the diagonal's elements in descending order, as they were before: those that are there twice, as
/// neighbours, stay neighbours.
Vector HermitianPivotedCholesky::pivots() const {
  return every_second(as_real_.pivots());
}

Eigen::VectorXcd HermitianPivotedCholesky::solve(const Eigen::VectorXcd& right) const {
  Vector real(2 * right.size());
  for (Index i = 0; i < right.size(); ++i) {
    real[2 * i] = right[i].real();
    real[2 * i + 1] = right[i].imag();
  }
  real = as_real_.solve(real);
  Eigen::VectorXcd result(right.size());
  for (Index i = 0; i < right.size(); ++i) result[i] = {real[2 * i], real[2 * i + 1]};
  return result;
}

ComplexPivotedQr::ComplexPivotedQr(const Eigen::MatrixXcd& A) : factor_(A) {}

double ComplexPivotedQr::min_pivot() const {
  return factor_.matrixR().diagonal().cwiseAbs().minCoeff();
}

Eigen::MatrixXcd ComplexPivotedQr::solve(const Eigen::MatrixXcd& right) const {
  return factor_.solve(right);
}

Eigen::MatrixXcd ComplexPivotedQr::inverse_root() const {
  const Index n = factor_.cols();
  const Eigen::MatrixXcd R = factor_.matrixR().topRows(n);
  return factor_.colsPermutation() * R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXcd::Identity(n, n)).eval();
}

}  // namespace mbk::numeric
