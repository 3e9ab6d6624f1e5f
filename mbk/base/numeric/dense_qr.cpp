#include <algorithm>
#include <utility>

#include "mbk/base/numeric/dense_solver.h"

#ifdef MBK_REFLECTIONS
namespace Eigen::internal {
MBK_REFLECTIONS(template)
}  // namespace Eigen::internal
#endif

namespace mbk::numeric {

template class DenseSolver<Eigen::ColPivHouseholderQR<Matrix>>;
template class DenseSolver<Eigen::CompleteOrthogonalDecomposition<Matrix>>;

Matrix householder_triangle(Matrix A) {
  const Index rows = std::min(A.rows(), A.cols());
  const Eigen::HouseholderQR<Eigen::Ref<Matrix>> qr(A);
  return A.topRows(rows).triangularView<Eigen::Upper>();
}

Matrix householder_solve(const Matrix& A, const Matrix& B) {
  return Eigen::HouseholderQR<Matrix>(A).solve(B);
}

PivotedQr::PivotedQr(const Matrix& A, double threshold) : DenseSolver(A) {
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

Matrix CompleteOrthogonal::pseudo_inverse() const {
  return factor_.pseudoInverse();
}

}  // namespace mbk::numeric
