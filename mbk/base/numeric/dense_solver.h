#pragma once

// What every decomposition does alike, for the files that instantiate it.
#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {

template <typename Factor>
DenseSolver<Factor>::DenseSolver(const Matrix& A) : factor_(A) {}

template <typename Factor>
Vector DenseSolver<Factor>::solve_vector(const Vector& right) const {
  return factor_.solve(right);
}

template <typename Factor>
Matrix DenseSolver<Factor>::solve_matrix(const Matrix& right) const {
  return factor_.solve(right);
}

}  // namespace mbk::numeric

// Blocks of Householder reflections on a matrix of doubles, which three files would compile alike; dense_qr.cpp does.
// The names are those of Eigen 3.4.0; with another version nothing is declared (mbk/base/core/matrix_products.h).
#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4 && EIGEN_MINOR_VERSION == 0
// NOLINTBEGIN(cppcoreguidelines-macro-usage)
#define MBK_REFLECTIONS(instantiate)                                                                    \
  instantiate void apply_block_householder_on_the_left(Block<MatrixXd, Dynamic, Dynamic, false>&,       \
                                                       const Block<MatrixXd, Dynamic, Dynamic, false>&, \
                                                       const VectorBlock<const VectorXd, Dynamic>&, bool);
// NOLINTEND(cppcoreguidelines-macro-usage)

namespace Eigen::internal {
MBK_REFLECTIONS(extern template)
}  // namespace Eigen::internal
#endif
