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
