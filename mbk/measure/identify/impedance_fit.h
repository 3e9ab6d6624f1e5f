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
  std::optional<Method> method;  ///< absent: least squares; measurement::measure chooses from the perturbation
  Structure structure = Structure::full;
  std::optional<ParametersFrom> parameters_from;  ///< absent: all for underdamped in default mode, else identification
  /// Λ [kg], subtracted from the diagonal of M (eq. 3.7); absent: in default mode the value in the recording, in
  /// reference mode none.
  std::optional<double> handle_mass;
  double hac_lag_s = 1.0;  ///< noise correlation time allowed for in the standard errors [s], ≥ 0
  bool decimate_check = false;
  int bootstrap = 0;       ///< replicates; 0: none
  double block_s = 2.5;    ///< of the bootstrap [s], longer than the noise correlation time
  std::uint64_t seed = 1;  ///< of the bootstrap
  unsigned threads = 1;    ///< of the bootstrap; the numbers do not depend on it
};

/// Least squares of −F = M ẍ + B ẋ + K (x − x₀), that is of −F on [ẍ ẋ x 1]   (Dyck 2013, eq. 3.2, 3.7–3.9).
/// x₀ = −K⁻¹c; the standard errors are those of Newey & West, valid for coloured residuals, widened so that
/// ±1.96 of them is a 95 % interval at this length of data (Kiefer & Vogelsang), and carried into x₀ by the delta
/// method. Several trials are one fit: rows are stacked, products of residuals never cross a break.
///
/// Not reliable if the limb moves the robot actively: position and force are then measured in a closed loop, and least
/// squares is biased towards the negative robot impedance; noise in the position biases the inertia towards zero. The
/// warnings report what is observable of this. If the regressors are linearly dependent (rank), there is no model: all
/// its numbers are NaN, and it is not usable. With Method::instrumental_variables the
/// same rows are solved by θ = (RᵀZ)⁻¹RᵀY, R from the known perturbation (instruments.h): activity of the limb and
/// noise of the position are then noise and cause no bias.
/// @fails trials differ in axes, units or rate; no data; fewer samples than parameters; a value is not
/// finite; no reference for instrumental variables; the lag is negative or not finite; the handle mass is not finite,
/// not recorded as a number, or differs between trials.
[[nodiscard]] Result<Identification> identify_impedance(const std::vector<PreparedTrial>& trials,
                                                        const Options& options);

/// Both methods on the same rows.
struct Comparison {
  Identification least_squares, instrumental_variables;
  Disagreement disagreement;
};

/// @fails as identify_impedance with instrumental variables, also if no reference was recorded.
[[nodiscard]] Result<Comparison> compare_methods(const std::vector<PreparedTrial>& trials, const Options& options);

/// m_xx m_xy m_yx m_yy b_xx … k_yy x0 y0; with one axis m b k x0.
[[nodiscard]] std::vector<std::string> parameter_names(int axes);

}  // namespace mbk::identify
