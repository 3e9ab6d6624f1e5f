#include <Eigen/Eigenvalues>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

Eigen::VectorXcd eigenvalues(const Matrix& A) {
  return Eigen::EigenSolver<Matrix>(A, false).eigenvalues();
}

}  // namespace mbk::numeric
