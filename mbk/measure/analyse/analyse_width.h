#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/width.h"

namespace mbk::analyse {

/// How far inertia, damping and stiffness of two results are apart (impedance/width.h), with intervals by the delta
/// method; both are taken as measured apart, each with its own noise. A distance is never negative: noise alone gives
/// one, so that only `distinguishable` says whether there is a difference, by Wald's test of the symmetric parts,
///   δᵀ (C₁ + C₂)⁻¹ δ > χ²₀.₉₅ of 3 (one axis: 1) degrees of freedom,  δ = [z_xx z_s z_yy]₂ − [z_xx z_s z_yy]₁
/// A matrix whose symmetric part is not positive definite has no width; the reason is kept.
/// @fails  one has one axis and the other two, or one is in kg and the other in kg·m².
[[nodiscard]] Result<WidthFindings> analyse_width(const Identification& first, const Identification& second);

}  // namespace mbk::analyse
