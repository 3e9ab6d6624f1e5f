#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/width.h"

namespace mbk::analyse {

/// Width between inertia, damping and stiffness of two results (impedance/width.h), with intervals by the delta method;
/// the noise of the two results is assumed independent. A width is never negative, and noise alone makes it positive:
/// only `distinguishable` shows whether there is a difference, by Wald's test of the symmetric parts,
///   δᵀ (C₁ + C₂)⁻¹ δ > χ²₀.₉₅ of 3 (one axis: 1) degrees of freedom,  δ = [z_xx z_s z_yy]₂ − [z_xx z_s z_yy]₁
/// A matrix whose symmetric part is not positive definite has no width; the reason is stored.
/// @fails  the results differ in the number of axes, or one is in kg and the other in kg·m².
[[nodiscard]] Result<WidthFindings> analyse_width(const Identification& first, const Identification& second);

}  // namespace mbk::analyse
