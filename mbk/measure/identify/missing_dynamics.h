#pragma once

#include <vector>

#include "mbk/measure/identify/regression.h"

namespace mbk::identify {

struct TestedAssumptions {
  std::vector<AssumptionTest> found;
  /// n, size of the mean of −F that the products x_i x_j account for: the constant of the model holds it, so that x₀ is
  /// off by K⁻¹ times this [N or N·m]. Zero where noise makes as much, empty where it was not fitted.
  Vector curvature;
};

/// Tests what M, B and K leave out: each kind of dynamics that a limb or a sensor may have beside them is added to the
/// regression, and what it explains is compared with chance,
///   −F = M ẍ + B ẋ + K x + c + Σ_k W_k γ_k,
/// with W the jerk (force and motion that are not simultaneous, a grip that yields, a late response), |x|² x, ẋ/|ẋ|,
/// Kx and Bẋ times slow cosines of time, x behind 1/(1 + sτ) for τ of 0.1, 0.5 and 1.5 s (a force that relaxes), and
/// |ẋ_i| with x_i x_j (what is not alike in opposite directions). Where the reference is known, motion is replaced by
/// what the past and present of the reference explain of it (each half of the rows by the response of the other half),
/// so that noise in a closed loop is not taken for dynamics. Rows are whitened by an autoregression of the residual;
/// the covariance of γ is that of White (1980), each residual divided by one less its leverage (MacKinnon and White
/// 1985), and the test an F test for each axis, with Bonferroni's bound over the axes. What is found first, with the
/// smallest chance, joins the model before the others are tested again. A slow trend of the residual is compared with
/// the slow waves beside it.
///
/// An assumption is contradicted where chance is below 10⁻⁵ (a trend: 1 % in noise of 1/f, far less in white) and the
/// finding matters: M, B or K change by more than their 95 % intervals when it is modelled, hardening also by a
/// twentieth of the stiffness; a stiffness or damping that changes, by a tenth; a memory must explain 3 % of the force
/// (root mean square), and what is even 6 % of it, since the geometry of an arm is quadratic. Without a known reference
/// it must explain 0.2 % of the force, too.
/// @param coefficients (3n+1)×n, of the fit    @param errors standard errors of the same    @param band [Hz] up to
/// which the rows hold anything    @param ranges rows that count
/// @returns none where there are too few rows for that
[[nodiscard]] TestedAssumptions test_assumptions(const Regression& r, const Matrix& coefficients, const Matrix& errors,
                                                 double band, const std::vector<RowRange>& ranges);

}  // namespace mbk::identify
