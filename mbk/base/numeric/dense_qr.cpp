#include <algorithm>
#include <utility>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Matrix householder_triangle(Matrix A) {
  const Index rows = std::min(A.rows(), A.cols());
  const Eigen::HouseholderQR<Eigen::Ref<Matrix>> qr(A);
  return A.topRows(rows).triangularView<Eigen::Upper>();
}

Matrix householder_solve(const Matrix& A, const Matrix& B) {
  return Eigen::HouseholderQR<Matrix>(A).solve(B);
}

PivotedQr::PivotedQr(const Matrix& A) : factor_(A) {}

PivotedQr::PivotedQr(const Matrix& A, double threshold) : factor_(A) {
  factor_.setThreshold(threshold);
}

Index PivotedQr::rank() const {
  return factor_.rank();
}

Matrix PivotedQr::inverse() const {
  return factor_.inverse();
}

Matrix PivotedQr::rest(Matrix of) const {
  of.applyOnTheLeft(factor_.householderQ().adjoint());
  of.topRows(factor_.rank()).setZero();
  of.applyOnTheLeft(factor_.householderQ());
  return of;
}

Vector PivotedQr::solve_vector(const Vector& right) const {
  return factor_.solve(right);
}

Matrix PivotedQr::solve_matrix(const Matrix& right) const {
  return factor_.solve(right);
}

CompleteOrthogonal::CompleteOrthogonal(const Matrix& A) : factor_(A) {}

Matrix CompleteOrthogonal::pseudo_inverse() const {
  return factor_.pseudoInverse();
}

Vector CompleteOrthogonal::solve_vector(const Vector& right) const {
  return factor_.solve(right);
}

Matrix CompleteOrthogonal::solve_matrix(const Matrix& right) const {
  return factor_.solve(right);
}

}  // namespace mbk::numeric
