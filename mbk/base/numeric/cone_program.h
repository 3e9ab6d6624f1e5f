#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::numeric {

/// The symmetric part of the n×n matrix whose columns, one under the other, are A x + b is positive semidefinite; with
/// n = 1, that number is not negative.
struct SemidefiniteCone {
  Matrix A;  ///< n²×(number of variables)
  Vector b;  ///< n²
};

/// minimise ½ xᵀP x + qᵀx  over the x that meet every cone, with P symmetric positive semidefinite.
struct ConeProgram {
  Matrix P;  ///< v×v
  Vector q;  ///< v
  std::vector<SemidefiniteCone> cones;
};

/// A minimum and what proves it. S_k ⪰ 0 and Y_k ⪰ 0 hold, and S_k Y_k = 0, by construction; what is left to see are
///   S_k = sym(A_k x + b_k)   and   P x + q = Σ_k A_kᵀ vec Y_k.
/// Residuals are in units of the largest number in the scaled program.
struct ConeSolution {
  Vector x;                        ///< v
  std::vector<Matrix> slack;       ///< S_k, n×n
  std::vector<Matrix> multiplier;  ///< Y_k, n×n; 0 where the cone does not press
  double value = 0;                ///< ½ xᵀP x + qᵀx
  double dual_value = 0;           ///< −½ xᵀP x − Σ b_kᵀ vec Y_k
  double primal_residual = 0;      ///< of the first equation
  double dual_residual = 0;        ///< of the second
  double gap = 0;                  ///< |value − dual_value|/(1 + |value| + |dual_value|), in the scaled program
  int iterations = 0;              ///< of the alternating direction method
  int newton_steps = 0;            ///< of the polish
};

/// Small and dense. The alternating direction method of multipliers, whose one nonlinear step clips eigenvalues (Boyd
/// et al. 2011), finds which eigenvalues are zero; a semismooth Newton method then solves
///   P x + q = Aᵀ(Π(z) − z),  A x + b = Π(z)        (Π clips the negative eigenvalues; S = Π(z), Y = Π(z) − z)
/// to rounding. The program is scaled inside: units do not matter.
/// @fails usage: shapes do not fit; a value is not finite; a direction exists that neither P nor a cone sees. not
/// usable: the residuals and the gap do not fall below 1e-10, as where the cones contradict each other, where no x is
/// strictly inside them, or where there is no minimum.
[[nodiscard]] Result<ConeSolution> solve_cone_program(const ConeProgram& program);

}  // namespace mbk::numeric
