#include <Eigen/LU>
#include <Eigen/QR>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Eigen::MatrixXcd complex_inverse(const Eigen::MatrixXcd& A) {
  return A.inverse();
}

double least_pivot(const Eigen::MatrixXcd& A) {
  return Eigen::FullPivLU<Eigen::MatrixXcd>(A).matrixLU().diagonal().cwiseAbs().minCoeff();
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
