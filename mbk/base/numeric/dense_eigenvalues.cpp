#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/MatrixFunctions>

#include "mbk/base/numeric/dense_solver.h"

namespace mbk::numeric {

Eigen::VectorXcd eigenvalues(const Matrix& A) {
  return Eigen::EigenSolver<Matrix>(A, false).eigenvalues();
}

Matrix matrix_exponential(const Matrix& A) {
  return A.exp();
}

}  // namespace mbk::numeric
