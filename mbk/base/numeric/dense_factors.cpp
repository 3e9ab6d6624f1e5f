#include "mbk/base/numeric/dense_solver.h"

namespace mbk::numeric {

template class DenseSolver<Eigen::LLT<Matrix>>;
template class DenseSolver<Eigen::LDLT<Matrix>>;
template class DenseSolver<Eigen::PartialPivLU<Matrix>>;
template class DenseSolver<Eigen::FullPivLU<Matrix>>;

Matrix inverse(const Matrix& A) {
  return A.inverse();
}

double determinant(const Matrix& A) {
  return A.determinant();
}

Matrix Cholesky::upper() const {
  return factor_.matrixU();
}

Vector PivotedCholesky::pivots() const {
  return factor_.vectorD();
}

double Lu::reciprocal_condition() const {
  return factor_.rcond();
}

bool FullyPivotedLu::invertible() const {
  return factor_.isInvertible();
}

Matrix FullyPivotedLu::inverse() const {
  return factor_.inverse();
}

}  // namespace mbk::numeric
