#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/model/perturbation/multisine.h"
#include "mbk/model/perturbation/phases.h"

namespace mbk::perturbation {

/// M ẍ + B ẋ + K x = −F of one axis, as estimated before the experiment [kg, N·s/m, N/m].
struct NominalImpedance {
  double M = 0.0;
  double B = 0.0;
  double K = 0.0;
};

/// Which signal is limited: the position, the velocity, or the response force of the nominal impedance.
enum class LimitedSignal { position, velocity, force };

[[nodiscard]] constexpr auto word_table(LimitedSignal) {
  using enum LimitedSignal;
  return std::to_array<Word<LimitedSignal>>({{position, "position"}, {velocity, "velocity"}, {force, "force"}});
}

struct OptimalPowerOptions {
  LimitedSignal limited = LimitedSignal::position;
  std::optional<NominalImpedance> nominal;  ///< needed for a limited force only
  /// Minimum share of the limited power at every line, so that a second-order model can be checked within the band.
  /// With a floor above 0 there must be three lines between the lowest and the highest.
  double floor = 0.02;
};

/// Distribution of the power of the limited signal over the lines, and the proof of its optimality.
struct OptimalPower {
  Vector shares;               ///< wₖ, sum 1, in the order of the harmonics
  Vector sensitivity;          ///< dₖ = tr(I(w)⁻¹ Iₖ); Σ wₖ dₖ = 3
  double gap = 0.0;            ///< ln det of the optimum is at most this much above the one found
  double log_determinant = 0;  ///< ln det I(w), of frequencies relative to the highest line
  int iterations = 0;
};

/// Shares w of power that are D-optimal for M, B and K of one axis:
///   max_w ln det I(w),   I(w) = Σₖ wₖ Iₖ,   Iₖ = [ωₖ⁴ 0 −ωₖ²; 0 ωₖ² 0; −ωₖ² 0 1]/cₖ,   wₖ ≥ floor, Σ wₖ = 1
/// where I is the information of the regression of force on [ẍ ẋ x] under white force noise, and cₖ is the limited
/// power for each unit of position power: 1 for position, ωₖ² for velocity, |K − M ωₖ² + jBωₖ|² for force.
/// Multiplicative algorithm on what is above the floor, w = floor + (1 − n·floor) v, vₖ ← vₖ dₖ / Σⱼ vⱼ dⱼ
/// (Titterington 1976; Silvey, Titterington & Torsney 1978), which never lowers the determinant. It stops at gap ≤
/// 1e-7, where by concavity
///   gap = (1 − n·floor)(maxₖ dₖ − Σⱼ vⱼ dⱼ)
/// bounds the gap to the optimum. Without a floor this is the general equivalence theorem (Kiefer & Wolfowitz 1960): w
/// is optimal if and only if dₖ ≤ 3 at every line, the number of parameters.
///
/// Limited position, no floor: with u = ω², det I = E[u] Var[u] under w. For a given mean the variance is largest with
/// all power at the ends a < b; with share q at b, (a + q(b − a)) q(1 − q)(b − a)² is largest at
///   q = (1 − r + √(1 + r + r²))/3,   r = a/(b − a),
/// so for a ≪ b two thirds of the power go to the highest line and one third to the lowest.
/// @param period  T [s]; line k is at k/T    @param harmonics  distinct, > 0, at least two
/// @fails  T ≤ 0; fewer than two harmonics, one < 1 or twice; floor < 0 or floor·n ≥ 1; floor > 0 and fewer than five
/// harmonics; force is limited and no nominal impedance given, or one not finite or zero at a line; not converged.
[[nodiscard]] Result<OptimalPower> optimal_power(double period, const std::vector<int>& harmonics,
                                                 const OptimalPowerOptions& options = {});

}  // namespace mbk::perturbation
