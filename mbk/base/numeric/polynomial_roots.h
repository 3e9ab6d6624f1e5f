#pragma once

#include <complex>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::numeric {

/// Roots of c₀ + c₁ x + … + cₙ xⁿ: eigenvalues of the companion matrix, x scaled by the geometric mean of the roots.
/// Leading zeros are ignored. The largest modulus comes last; pairs are adjacent, the positive imaginary part first.
/// @param ascending finite    @returns one for each degree; none for a constant
[[nodiscard]] Eigen::VectorXcd polynomial_roots(const Vector& ascending);

/// c₀ … cₙ₋₁ of the monic polynomial with these roots, c₀ + … + cₙ₋₁ xⁿ⁻¹ + xⁿ.
/// @param roots real ones and conjugate pairs
[[nodiscard]] Vector monic_from_roots(const Eigen::VectorXcd& roots);

/// p(x), by Horner's scheme.
[[nodiscard]] std::complex<double> polynomial_at(const Vector& ascending, std::complex<double> x);

}  // namespace mbk::numeric
