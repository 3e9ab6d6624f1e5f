#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::identify {

struct Options {
  std::optional<Method> method;  ///< absent: least squares; measurement::measure chooses by what perturbed the limb
  Structure structure = Structure::full;
  std::optional<ParametersFrom> parameters_from;  ///< absent: all for underdamped in default mode, else identification
  /// Λ [kg], subtracted from the diagonal of M (eq. 3.7); absent: in default mode what the recording says, in reference
  /// mode none.
  std::optional<double> handle_mass;
  double hac_lag_s = 1.0;  ///< reach of the residual's autocovariance in the standard errors [s], ≥ 0
  bool decimate_check = false;
  int bootstrap = 0;       ///< replicates; 0: none
  double block_s = 2.5;    ///< of the bootstrap [s], longer than the residual's correlation
  std::uint64_t seed = 1;  ///< of the bootstrap
  unsigned threads = 1;    ///< of the bootstrap; the numbers do not depend on it
};

/// Least squares of −F = M ẍ + B ẋ + K (x − x₀), that is of −F on [ẍ ẋ x 1]   (Dyck 2013, eq. 3.2, 3.7–3.9).
/// x₀ = −K⁻¹c; the standard errors are those of Newey & West, which hold for coloured residuals, widened so that
/// ±1.96 of them is a 95 % interval at this length of data (Kiefer & Vogelsang), and carried into x₀ by the delta
/// method. Several trials are one fit: rows are stacked, products of residuals never cross a break.
///
/// Do not trust it where the limb pushes back on its own account: position and force are then measured in a closed
/// loop, and least squares is biased towards the negative robot impedance; noise in the position draws the
/// inertia towards zero. The warnings name what can be seen of this. Where the regressors cannot be distinguished
/// (rank) there is no model: every number of it is NaN, and it is not usable. With Method::instrumental_variables the
/// same rows are solved by θ = (RᵀZ)⁻¹RᵀY, R from the known perturbation (instruments.h): what the limb does on its own
/// account, and noise of the position, are then no bias but noise.
/// @fails trials differ in axes, units or rate; nothing to identify from; fewer samples than parameters; a value is not
/// finite; no reference for instrumental variables; the lag is negative or not finite; the handle's mass is not finite,
/// not recorded as a number, or not the same in all trials.
[[nodiscard]] Result<Identification> identify_impedance(const std::vector<PreparedTrial>& trials,
                                                        const Options& options);

/// Both methods on the same rows.
struct Comparison {
  Identification least_squares, instrumental_variables;
  Disagreement disagreement;
};

/// @fails as identify_impedance with instrumental variables: where no reference was recorded there is nothing to
/// compare.
[[nodiscard]] Result<Comparison> compare_methods(const std::vector<PreparedTrial>& trials, const Options& options);

/// m_xx m_xy m_yx m_yy b_xx … k_yy x0 y0; with one axis m b k x0.
[[nodiscard]] std::vector<std::string> parameter_names(int axes);

}  // namespace mbk::identify
