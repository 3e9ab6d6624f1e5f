#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::numeric {

/// The symmetric part of the n×n matrix whose columns, one under the other, are A x + b must be positive definite; the
/// nearer to `reference` the better, where nothing else decides.
struct DefiniteCondition {
  Matrix A;          ///< n²×v
  Vector b;          ///< n²
  Matrix reference;  ///< P, n×n, symmetric positive definite
};

/// minimise ½ Σ_{i < seen} x_i² + cᵀx  over the x that meet every condition. Directions that the sum does not see are
/// free but for the conditions, and those are decided by nearness to the references.
struct DefiniteProgram {
  Index seen = 0;
  Vector linear;  ///< c, v
  std::vector<DefiniteCondition> conditions;
  Vector tether;  ///< w ≥ 0, v: weight of ½ w_i (x_i − start_i)² beside the divergences, for what no condition holds
  Vector start;  ///< x₀, v; meets every condition
  /// The minimum is approached until the objective is at most about this far above it.
  double gap = 1e-4;
  std::optional<double> enough;  ///< stop where the objective is below this
};

struct DefiniteSolution {
  Vector x;                      ///< v; every condition holds strictly
  double value = 0;              ///< of the objective
  std::vector<Matrix> matrices;  ///< of the conditions, n×n
  /// For each condition Σ of the positive eigenvalues of μ (S⁻¹P − I): how much the objective would fall, to first
  /// order, were S + P allowed where S must be definite. 0 where the condition does not press.
  std::vector<double> pressure;
  double weight = 0;       ///< μ at the end
  double last_change = 0;  ///< of the objective when μ fell to that, for the tenth part
  int steps = 0;           ///< of Newton's method
};

/// Least squares within positive definite matrices: the minimisers of
///   ½ Σ_{i < seen} x_i² + cᵀx + μ [Σ_k D(S_k‖P_k) + ½ Σ w_i (x_i − x₀_i)²],  D(S‖P) = tr(P⁻¹S) − log det(P⁻¹S) − n,
/// are followed by a primal-dual interior point method as μ falls, until μ Σ n is the gap. D is the Bregman divergence
/// of −log det, the entropic divergence of Lee & Park 2018: a barrier, and as μ falls, what the sum does not see goes
/// to where Σ D is least.
/// @fails usage: shapes do not fit; a value is not finite; the start does not meet a condition, or a reference is not
/// positive definite. not usable: it does not settle (how far it came is
/// said), as where a direction is left that neither the sum nor a condition nor the tether sees.
[[nodiscard]] Result<DefiniteSolution> solve_definite_program(const DefiniteProgram& program);

}  // namespace mbk::numeric
