#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include "mbk/base/core/linear_algebra.h"

/// Eigen's decompositions of matrices whose size is known at run time, compiled here once: each use of one in a file of
/// its own costs the compiler one to three seconds there. Matrices of fixed size (2×2, 3×3) stay with Eigen, which
/// inlines them. A right side may be any expression; of one column it is solved as a vector.
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

/// A⁻¹ by Gaussian elimination with row pivots; not finite where A is singular.
[[nodiscard]] Matrix inverse(const Matrix& A);

/// R of A = Q R, min(m, n)×n with zeros below the diagonal.
[[nodiscard]] Matrix householder_triangle(Matrix A);
/// X with the least |A X − B|, for an A of full column rank.
[[nodiscard]] Matrix householder_solve(const Matrix& A, const Matrix& B);

/// solve() of any right side, by one of vectors and one of matrices that a decomposition defines.
template <typename Decomposition>
class DenseSolver {
 public:
  template <typename Right>
  [[nodiscard]] auto solve(const Eigen::MatrixBase<Right>& right) const {
    const auto& self = static_cast<const Decomposition&>(*this);
    if constexpr (Right::ColsAtCompileTime == 1) {
      return self.solve_vector(right);
    } else {
      return self.solve_matrix(right);
    }
  }
};

/// L Lᵀ of a positive definite matrix.
class Cholesky : public DenseSolver<Cholesky> {
 public:
  explicit Cholesky(const Matrix& A);
  [[nodiscard]] bool positive_definite() const { return factor_.info() == Eigen::Success; }
  [[nodiscard]] Matrix upper() const;
  [[nodiscard]] Vector solve_vector(const Vector& right) const;
  [[nodiscard]] Matrix solve_matrix(const Matrix& right) const;

 private:
  Eigen::LLT<Matrix> factor_;
};

/// Pᵀ L D Lᵀ P of a symmetric matrix.
class PivotedCholesky : public DenseSolver<PivotedCholesky> {
 public:
  explicit PivotedCholesky(const Matrix& A);
  [[nodiscard]] bool positive() const { return factor_.isPositive(); }
  [[nodiscard]] Vector pivots() const;
  [[nodiscard]] Vector solve_vector(const Vector& right) const;
  [[nodiscard]] Matrix solve_matrix(const Matrix& right) const;

 private:
  Eigen::LDLT<Matrix> factor_;
};

/// The same of a Hermitian matrix.
class HermitianPivotedCholesky {
 public:
  explicit HermitianPivotedCholesky(const Eigen::MatrixXcd& A);
  [[nodiscard]] Vector pivots() const;
  [[nodiscard]] Eigen::VectorXcd solve(const Eigen::VectorXcd& right) const;

 private:
  Eigen::LDLT<Eigen::MatrixXcd> factor_;
};

/// Q R Pᵀ by Householder reflections, columns in descending order of length.
class PivotedQr : public DenseSolver<PivotedQr> {
 public:
  explicit PivotedQr(const Matrix& A);
  /// Pivots below `threshold` of the largest count as zero.
  PivotedQr(const Matrix& A, double threshold);
  [[nodiscard]] Index rank() const;
  [[nodiscard]] Matrix inverse() const;
  /// What the columns of A cannot make of `of`: (I − Q₁ Q₁ᵀ) of.
  [[nodiscard]] Matrix rest(Matrix of) const;
  [[nodiscard]] Vector solve_vector(const Vector& right) const;
  [[nodiscard]] Matrix solve_matrix(const Matrix& right) const;

 private:
  Eigen::ColPivHouseholderQR<Matrix> factor_;
};

/// The least-norm solution where A lacks rank.
class CompleteOrthogonal : public DenseSolver<CompleteOrthogonal> {
 public:
  explicit CompleteOrthogonal(const Matrix& A);
  [[nodiscard]] Matrix pseudo_inverse() const;
  [[nodiscard]] Vector solve_vector(const Vector& right) const;
  [[nodiscard]] Matrix solve_matrix(const Matrix& right) const;

 private:
  Eigen::CompleteOrthogonalDecomposition<Matrix> factor_;
};

/// P A = L U.
class Lu : public DenseSolver<Lu> {
 public:
  explicit Lu(const Matrix& A);
  [[nodiscard]] double reciprocal_condition() const;
  [[nodiscard]] Vector solve_vector(const Vector& right) const;
  [[nodiscard]] Matrix solve_matrix(const Matrix& right) const;

 private:
  Eigen::PartialPivLU<Matrix> factor_;
};

/// P A Q = L U.
class FullyPivotedLu : public DenseSolver<FullyPivotedLu> {
 public:
  explicit FullyPivotedLu(const Matrix& A);
  [[nodiscard]] bool invertible() const;
  [[nodiscard]] Matrix inverse() const;
  [[nodiscard]] Vector solve_vector(const Vector& right) const;
  [[nodiscard]] Matrix solve_matrix(const Matrix& right) const;

 private:
  Eigen::FullPivLU<Matrix> factor_;
};

}  // namespace mbk::numeric
