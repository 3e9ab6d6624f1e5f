#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Matrix inverse(const Matrix& A) {
  return A.inverse();
}

Cholesky::Cholesky(const Matrix& A) : factor_(A) {}

Matrix Cholesky::upper() const {
  return factor_.matrixU();
}

Vector Cholesky::solve_vector(const Vector& right) const {
  return factor_.solve(right);
}

Matrix Cholesky::solve_matrix(const Matrix& right) const {
  return factor_.solve(right);
}

PivotedCholesky::PivotedCholesky(const Matrix& A) : factor_(A) {}

Vector PivotedCholesky::pivots() const {
  return factor_.vectorD();
}

Vector PivotedCholesky::solve_vector(const Vector& right) const {
  return factor_.solve(right);
}

Matrix PivotedCholesky::solve_matrix(const Matrix& right) const {
  return factor_.solve(right);
}

HermitianPivotedCholesky::HermitianPivotedCholesky(const Eigen::MatrixXcd& A) : factor_(A) {}

Vector HermitianPivotedCholesky::pivots() const {
  return factor_.vectorD().real();
}

Eigen::VectorXcd HermitianPivotedCholesky::solve(const Eigen::VectorXcd& right) const {
  return factor_.solve(right);
}

Lu::Lu(const Matrix& A) : factor_(A) {}

double Lu::reciprocal_condition() const {
  return factor_.rcond();
}

Vector Lu::solve_vector(const Vector& right) const {
  return factor_.solve(right);
}

Matrix Lu::solve_matrix(const Matrix& right) const {
  return factor_.solve(right);
}

FullyPivotedLu::FullyPivotedLu(const Matrix& A) : factor_(A) {}

bool FullyPivotedLu::invertible() const {
  return factor_.isInvertible();
}

Matrix FullyPivotedLu::inverse() const {
  return factor_.inverse();
}

Vector FullyPivotedLu::solve_vector(const Vector& right) const {
  return factor_.solve(right);
}

Matrix FullyPivotedLu::solve_matrix(const Matrix& right) const {
  return factor_.solve(right);
}

}  // namespace mbk::numeric
