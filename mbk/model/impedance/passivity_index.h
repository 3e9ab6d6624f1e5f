#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/impedance/model.h"

namespace mbk::impedance {

/// A number that follows from a model, and its derivative by the model's stacked M, B, K and x₀ (model.h), for the
/// delta method.
struct Sensitive {
  double value = 0;
  Eigen::RowVectorXd gradient;
};

/// Its standard error by the delta method; NaN if there is no covariance.
/// @param covariance of the stacked model
[[nodiscard]] double standard_error(const Sensitive& quantity, const Matrix& covariance);

/// M (0), B (1) or K (2).
[[nodiscard]] const Matrix& matrix_of(const Model& model, int matrix);

/// Smallest eigenvalue of the symmetric part of M (0), B (1) or K (2): dλ = vᵀ dZ v.
[[nodiscard]] Sensitive smallest_eigenvalue(const Model& model, int matrix);

/// Passivity index at one frequency, ½ λ_min(Z(jω) + Zᴴ(jω)) with Z(s) = M s + B + K/s: the smallest damping of the
/// limb over direction and phase [N·s/m]. In closed form
///   tr(B_s)/2 − √( ((b_xx − b_yy)/2)² + b_s² + (ω m_a − k_a/ω)² ),
/// with B_s = (B + Bᵀ)/2, and m_a, k_a the antisymmetric parts of M and K. One axis: b. Three axes: the smallest
/// eigenvalue of B_s + j [a]×, a = ω m_a − k_a/ω of antisymmetric_vector.
/// Over a band its minimum is at an end: |ω m_a − k_a/ω| is largest there; with three axes, the frequencies at which it
/// exceeds any δ form one interval, since aᵀ(B_s − δI)a is convex in log ω (docs/theory/passivity.md).
/// @param omega > 0 [rad/s]
[[nodiscard]] Sensitive passivity_index(const Model& model, double omega);

/// √det B_s ∓ (ω m_a − k_a/ω), `sign` = ±1: both are positive where B_s is positive definite and the index is positive.
/// NaN where det B_s ≤ 0; with one axis b. Three axes: √(det B_s/(uᵀ B_s u)) − |a| with a = |a| u, whatever the sign.
/// @param omega > 0 [rad/s]
[[nodiscard]] Sensitive antisymmetry_margin(const Model& model, double omega, int sign);

/// Below this frequency [Hz] the antisymmetric stiffness makes a limb without inertial antisymmetry active:
/// |k_a|/(2π √det B_s); with three axes √(k_aᵀ B_s k_a/det B_s)/(2π). Absent where B_s is not positive definite. 0 with
/// one axis.
[[nodiscard]] std::optional<double> nonpassive_below(const Model& model);

/// Where the index of a model of several axes whose B_s is positive definite is positive, ω from first to second
/// [rad/s]; for two axes
/// |ω m_a − k_a/ω| < √det B_s. With m_a = 0 above |k_a|/√det B_s; with k_a = 0 below √det B_s/|m_a|; with
/// D = det B_s + 4 m_a k_a from 2|k_a|/(√det B_s + √D) to (√det B_s + √D)/(2|m_a|). Beyond, circular motion can draw
/// energy from the model. The second is infinite if m_a = 0. For three axes: aᵀ B_s a < det B_s, quadratic in ω².
/// @returns absent with one axis, where B_s is not positive definite, or D ≤ 0: then there is no such frequency
[[nodiscard]] std::optional<std::pair<double, double>> absorbing_in_circles(const Model& model);

/// Excess of passivity of the symmetric part: the largest δ for which Z − δI is still positive real, λ_min(B_s)
/// [N·s/m]. Absent unless the symmetric parts of M and K are positive semidefinite.
[[nodiscard]] std::optional<Sensitive> excess_of_passivity(const Model& model);

/// The value printed in table 3.6 of Dyck (2013) instead, λ_max(B_s)/2. It is not an excess of passivity: half of the
/// *largest* eigenvalue (docs/theory/errata.md).
[[nodiscard]] Sensitive published_excess_of_passivity(const Model& model);

}  // namespace mbk::impedance
