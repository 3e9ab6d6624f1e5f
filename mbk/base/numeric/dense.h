#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "mbk/base/core/linear_algebra.h"

/// Eigen's decompositions, compiled here once: each use of one in a file of its own costs the compiler one to three
/// seconds there. Only what Eigen writes out by itself (an inverse or a determinant up to 3×3), and what must not
/// allocate, stays with matrices of fixed size. A right side may be any expression; of one column it is solved as a
/// vector.
namespace mbk::numeric {

/// A V = V Λ.
struct SymmetricEigen {
  Vector values;   ///< n, ascending
  Matrix vectors;  ///< n×n, unit columns
};

/// Of a symmetric matrix, of which the lower triangle is read.
[[nodiscard]] SymmetricEigen symmetric_eigen(const Matrix& A);
[[nodiscard]] Vector symmetric_eigenvalues(const Matrix& A);
/// Of a Hermitian matrix, ascending; the lower triangle is read.
[[nodiscard]] Vector hermitian_eigenvalues(const Eigen::MatrixXcd& A);
/// A V = B V Λ with B positive definite and Vᵀ B V = I.
[[nodiscard]] SymmetricEigen generalized_symmetric_eigen(const Matrix& A, const Matrix& B);
/// Of any square matrix, in no order.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Matrix& A);
/// Descending.
[[nodiscard]] Vector singular_values(const Matrix& A);
[[nodiscard]] Vector complex_singular_values(const Eigen::MatrixXcd& A);

/// A = U diag(values) Vᵀ, with k = min(m, n).
struct ThinSvd {
  Matrix U;       ///< m×k
  Vector values;  ///< k, descending
  Matrix V;       ///< n×k
};
[[nodiscard]] ThinSvd thin_svd(const Matrix& A);

/// A⁻¹ by Gaussian elimination with row pivots; not finite where A is singular.
[[nodiscard]] Matrix inverse(const Matrix& A);
/// Of any square matrix, by the same elimination.
[[nodiscard]] double determinant(const Matrix& A);
[[nodiscard]] Eigen::MatrixXcd complex_inverse(const Eigen::MatrixXcd& A);

/// e^A of a square matrix.
[[nodiscard]] Matrix matrix_exponential(const Matrix& A);

/// R of A = Q R, min(m, n)×n with zeros below the diagonal.
[[nodiscard]] Matrix householder_triangle(Matrix A);
/// X with the least |A X − B|, for an A of full column rank.
[[nodiscard]] Matrix householder_solve(const Matrix& A, const Matrix& B);

/// What all decompositions have in common: A is decomposed once, and solved for any right side.
template <typename Factor>
class DenseSolver {
 public:
  explicit DenseSolver(const Matrix& A);

  template <typename Right>
  [[nodiscard]] auto solve(const Eigen::MatrixBase<Right>& right) const {
    if constexpr (Right::ColsAtCompileTime == 1) {
      return solve_vector(right);
    } else {
      return solve_matrix(right);
    }
  }

 protected:
  Factor factor_;

 private:
  [[nodiscard]] Vector solve_vector(const Vector& right) const;
  [[nodiscard]] Matrix solve_matrix(const Matrix& right) const;
};
extern template class DenseSolver<Eigen::LLT<Matrix>>;
extern template class DenseSolver<Eigen::LDLT<Matrix>>;
extern template class DenseSolver<Eigen::ColPivHouseholderQR<Matrix>>;
extern template class DenseSolver<Eigen::CompleteOrthogonalDecomposition<Matrix>>;
extern template class DenseSolver<Eigen::PartialPivLU<Matrix>>;
extern template class DenseSolver<Eigen::FullPivLU<Matrix>>;

/// L Lᵀ of a positive definite matrix.
class Cholesky : public DenseSolver<Eigen::LLT<Matrix>> {
 public:
  using DenseSolver::DenseSolver;
  [[nodiscard]] bool positive_definite() const { return factor_.info() == Eigen::Success; }
  [[nodiscard]] Matrix upper() const;
};

/// Pᵀ L D Lᵀ P of a symmetric matrix.
class PivotedCholesky : public DenseSolver<Eigen::LDLT<Matrix>> {
 public:
  using DenseSolver::DenseSolver;
  [[nodiscard]] bool positive() const { return factor_.isPositive(); }
  [[nodiscard]] Vector pivots() const;
};

/// The same of a Hermitian matrix.
class HermitianPivotedCholesky {
 public:
  explicit HermitianPivotedCholesky(const Eigen::MatrixXcd& A);
  [[nodiscard]] Vector pivots() const;
  [[nodiscard]] Eigen::VectorXcd solve(const Eigen::VectorXcd& right) const;

 private:
  PivotedCholesky as_real_;
};

/// Q R Pᵀ by Householder reflections, columns in descending order of length.
class PivotedQr : public DenseSolver<Eigen::ColPivHouseholderQR<Matrix>> {
 public:
  using DenseSolver::DenseSolver;
  /// Pivots below `threshold` of the largest count as zero.
  PivotedQr(const Matrix& A, double threshold);
  [[nodiscard]] Index rank() const;
  [[nodiscard]] Matrix inverse() const;
  /// What the columns of A cannot make of `of`: (I − Q₁ Q₁ᵀ) of.
  [[nodiscard]] Matrix rest(Matrix of) const;
};

/// The same of a complex matrix.
class ComplexPivotedQr {
 public:
  explicit ComplexPivotedQr(const Eigen::MatrixXcd& A);
  /// Of R's diagonal, the least absolute value.
  [[nodiscard]] double min_pivot() const;
  [[nodiscard]] Eigen::MatrixXcd solve(const Eigen::MatrixXcd& right) const;
  /// P R⁻¹, whose product with its adjoint is (A* A)⁻¹, for an A of full column rank.
  [[nodiscard]] Eigen::MatrixXcd inverse_root() const;

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXcd> factor_;
};

/// The least-norm solution where A lacks rank.
class CompleteOrthogonal : public DenseSolver<Eigen::CompleteOrthogonalDecomposition<Matrix>> {
 public:
  using DenseSolver::DenseSolver;
  [[nodiscard]] Matrix pseudo_inverse() const;
};

/// P A = L U.
class Lu : public DenseSolver<Eigen::PartialPivLU<Matrix>> {
 public:
  using DenseSolver::DenseSolver;
  [[nodiscard]] double reciprocal_condition() const;
};

/// P A Q = L U.
class FullyPivotedLu : public DenseSolver<Eigen::FullPivLU<Matrix>> {
 public:
  using DenseSolver::DenseSolver;
  [[nodiscard]] bool invertible() const;
  [[nodiscard]] Matrix inverse() const;
};

}  // namespace mbk::numeric
