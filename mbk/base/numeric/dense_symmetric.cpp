#include <Eigen/Eigenvalues>

#include "mbk/base/numeric/dense_solver.h"

namespace mbk::numeric {

SymmetricEigen symmetric_eigen(const Matrix& A) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Vector symmetric_eigenvalues(const Matrix& A) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricEigen generalized_symmetric_eigen(const Matrix& A, const Matrix& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(A, B);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Vector hermitian_eigenvalues(const Eigen::MatrixXcd& A) {
  // [Re A, −Im A; Im A, Re A] is symmetric and has each of them twice.
  const Index n = A.rows();
  Matrix twice(2 * n, 2 * n);
  twice.topLeftCorner(n, n) = twice.bottomRightCorner(n, n) = A.real();
  twice.bottomLeftCorner(n, n) = A.imag();
  for (Index i = 0; i < n; ++i) {
    for (Index k = i; k < n; ++k) twice(n + i, k) = i == k ? 0.0 : -A(k, i).imag();  // the lower triangle is read
  }
  return symmetric_eigenvalues(twice)(Eigen::seqN(0, n, 2));
}

}  // namespace mbk::numeric
