#include <Eigen/QR>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

namespace {

/// [Re A, −Im A; Im A, Re A], which is to real vectors [Re x; Im x] what A is to x. Its inverse is that of A written
/// so, and it has each singular value, each eigenvalue of a Hermitian A and each of its pivots twice.
Matrix as_real(const Eigen::MatrixXcd& A) {
  Matrix real(2 * A.rows(), 2 * A.cols());
  real << A.real(), -A.imag(), A.imag(), A.real();
  return real;
}

/// The same of a Hermitian matrix, as far as its lower triangle goes.
Matrix lower_as_real(const Eigen::MatrixXcd& A) {
  const Index n = A.rows();
  Matrix real = as_real(A);
  for (Index i = 0; i < n; ++i) {
    for (Index k = i; k < n; ++k) real(n + i, k) = i == k ? 0.0 : -A(k, i).imag();
  }
  return real;
}

Vector every_second(const Vector& values) {
  return values(Eigen::seqN(0, values.size() / 2, 2));
}

}  // namespace

Vector hermitian_eigenvalues(const Eigen::MatrixXcd& A) {
  return every_second(symmetric_eigenvalues(lower_as_real(A)));
}

Vector complex_singular_values(const Eigen::MatrixXcd& A) {
  return every_second(singular_values(as_real(A)));
}

Eigen::MatrixXcd complex_inverse(const Eigen::MatrixXcd& A) {
  const Matrix real = inverse(as_real(A));
  Eigen::MatrixXcd result(A.rows(), A.cols());
  result.real() = real.topLeftCorner(A.rows(), A.cols());
  result.imag() = real.bottomLeftCorner(A.rows(), A.cols());
  return result;
}

HermitianPivotedCholesky::HermitianPivotedCholesky(const Eigen::MatrixXcd& A) : as_real_(lower_as_real(A)) {}

Vector HermitianPivotedCholesky::pivots() const {
  return every_second(as_real_.pivots());
}

Eigen::VectorXcd HermitianPivotedCholesky::solve(const Eigen::VectorXcd& right) const {
  const Index n = right.size();
  Vector real(2 * n);
  real << right.real(), right.imag();
  real = as_real_.solve(real);
  Eigen::VectorXcd result(n);
  result.real() = real.head(n);
  result.imag() = real.tail(n);
  return result;
}

ComplexPivotedQr::ComplexPivotedQr(const Eigen::MatrixXcd& A) : factor_(A) {}

double ComplexPivotedQr::least_pivot() const {
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
