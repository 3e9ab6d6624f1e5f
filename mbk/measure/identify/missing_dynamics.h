#pragma once

#include <vector>

#include "mbk/measure/identify/regression.h"

namespace mbk::identify {

struct TestedAssumptions {
  std::vector<AssumptionTest> found;
  /// n, size of the mean of −F that the products x_i x_j account for: it is part of the constant of the model, so x₀ is
  /// biased by K⁻¹ times this [N or N·m]. Zero if noise explains it, empty if it was not fitted.
  Vector curvature;
};

/// Tests for dynamics missing in the model: each kind of dynamics that a limb or a sensor may have in addition to M, B
/// and K is added to the regression, and its significance is tested,
///   −F = M ẍ + B ẋ + K x + c + Σ_k W_k γ_k,
/// with W the jerk (force and motion not synchronised, a yielding grip, a delayed response), |x|² x, ẋ/|ẋ|,
/// Kx and Bẋ times slow cosines of time, x filtered by 1/(1 + sτ) for τ of 0.1, 0.5 and 1.5 s (a force that relaxes),
/// and |ẋ_i| with x_i x_j (asymmetry between opposite directions). If the reference is known, motion is replaced by the
/// part that past and present of the reference explain (each half of the rows with the response of the other half), so
/// that noise in a closed loop is not mistaken for dynamics. Rows are whitened by an autoregression of the residual;
/// the covariance of γ is that of White (1980), each residual divided by one less its leverage (MacKinnon and White
/// 1985), and the test an F test for each axis, with a Bonferroni correction over the axes. The most significant term
/// is added to the model before the others are re-tested. A slow trend of the residual is compared with neighbouring
/// slow components.
///
/// An assumption is contradicted if p is below 10⁻⁵ (for a trend: 1 % in 1/f noise, far less in white noise) and the
/// effect is relevant: M, B or K change by more than their 95 % intervals when it is modelled, hardening also by a
/// twentieth of the stiffness; a stiffness or damping that changes, by a tenth; a memory must explain 3 % of the force
/// (root mean square), an even nonlinearity 6 %, because the geometry of an arm is itself quadratic. Without a known
/// reference it must explain 0.2 % of the force, too.
/// @param coefficients (3n+1)×n, of the fit    @param errors standard errors of the same    @param band [Hz],
/// upper end of the signal content of the rows    @param ranges rows used
/// @returns none if there are too few rows
[[nodiscard]] TestedAssumptions test_assumptions(const Regression& r, const Matrix& coefficients, const Matrix& errors,
                                                 double band, const std::vector<RowRange>& ranges);

}  // namespace mbk::identify
