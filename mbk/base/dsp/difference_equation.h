#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::dsp {

/// y[k] = Σ_j b_j u[k − j] − Σ_{j≥1} a_j y[k − j], from rest: what B(q⁻¹)/A(q⁻¹) makes of u.
/// For coefficients that come out of an estimation; a filter by design is a cascade of sections (butterworth.h), which
/// loses no digits.
/// @param b b₀ … b_m    @param a 1, a₁ … a_n    @returns as many values as u has
[[nodiscard]] Vector difference_equation(const Vector& b, const Vector& a, const Vector& u);

}  // namespace mbk::dsp
