#include <Eigen/Eigenvalues>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Vector hermitian_eigenvalues(const Eigen::MatrixXcd& A) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace mbk::numeric
