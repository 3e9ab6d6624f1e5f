#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::numeric {

/// minimise ½ zᵀH z + gᵀz  subject to  C z = b,  G z ≤ h,  with H symmetric positive semidefinite.
struct QuadraticProgram {
  Matrix H;  ///< n×n
  Vector g;  ///< n
  Matrix C;  ///< p×n, of full row rank; p may be 0
  Vector b;  ///< p
  Matrix G;  ///< m×n, m > 0
  Vector h;  ///< m
};

/// A point that meets the conditions of Karush, Kuhn and Tucker: it is the minimum, since the program is convex.
///   H z + g + Cᵀy + Gᵀλ = 0,  C z = b,  G z ≤ h,  λ ≥ 0,  λ_i (h − G z)_i = 0
struct QuadraticSolution {
  Vector z;       ///< n
  Vector y;       ///< multipliers of C z = b, p
  Vector lambda;  ///< multipliers of G z ≤ h, m
  double value = 0.0;
  int iterations = 0;
};

/// Small and dense, by the primal-dual interior-point method with predictor and corrector (Mehrotra 1992). Scale the
/// variables to about 1 first; each condition is met to 1e-10 of the largest number in its own equation.
/// @fails  usage: shapes differ or a value is not finite. not usable: within 100 steps no point is found that meets
/// every condition, as where C z = b and G z ≤ h contradict each other.
[[nodiscard]] Result<QuadraticSolution> solve_quadratic_program(const QuadraticProgram& program);

}  // namespace mbk::numeric
