#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/cone_program.h"
#include "mbk/model/trial/consistent_fit.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::identify {

/// Coefficients θ, (3n+1)×n as of the regression, that meet the conditions of ConsistentFit.
struct ConsistentCoefficients {
  Matrix coefficients;  ///< minimum over the conditions
  Matrix tied;          ///< minimum with the ties (symmetry) alone
  numeric::ConeSolution certificate;
};

/// minimise Σ_j (θ_j − θ₀_j)ᵀ G (θ_j − θ₀_j)  over  M − Λ I ⪰ 0, K ⪰ 0, (B + Bᵀ)/2 ⪰ 0, M and K symmetric.
/// @param coefficients θ₀, (3n+1)×n: [M B K c]ᵀ with the handle    @param gram G, symmetric positive definite
/// @param structure full and symmetric are the same here; mass_spring ties M = m I, B = 0
/// @fails a value is not finite; G is not positive definite; as solve_cone_program.
[[nodiscard]] Result<ConsistentCoefficients> nearest_consistent(const Matrix& coefficients, const Matrix& gram,
                                                                Structure structure, double handle_mass);

/// The consistent model nearest to a free one, in terms of the force that both predict for the measured motion:
///   minimise Σ_t ‖f(t; θ) − f(t; θ₀)‖² = Σ_j (θ_j − θ₀_j)ᵀ ZᵀZ (θ_j − θ₀_j).
/// For a least-squares model this is constrained least squares on the same rows. Call it as
///   auto found = identify_impedance(trials, options);   auto consistent = consistent_model(trials, *found);
/// Handle mass, structure and data are those of `found`, with either method. A constraint hides a bias: use an unbiased
/// method if the limb moves the robot.
/// @fails the trials are not those of `found`; `found` has no model (rank, or x₀ not finite).
[[nodiscard]] Result<ConsistentFit> consistent_model(const std::vector<PreparedTrial>& trials,
                                                     const Identification& found);

}  // namespace mbk::identify
