#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/identify/regression.h"

namespace mbk::identify {

/// What the known perturbation alone makes the limb do: the instruments of the regression, N×(3n+1), row by row beside
/// its regressors [ẍ ẋ x 1].
struct Instruments {
  Matrix response;  ///< what a force makes of a nominal limb, [motion 1]; empty where they are the reference itself
  ReferenceQuantity from = ReferenceQuantity::unknown;  ///< what the reference was taken for
  Vector strength;                                      ///< 3n, conditional first-stage F of ẍ, ẋ, x
  Matrix gram = {};                                     ///< [R Z Y]ᵀ[R Z Y] of the rows that count

  /// R, whose motion is about its mean in the rows that count.
  [[nodiscard]] const Matrix& columns(const Regression& r) const {
    return response.size() > 0 ? response : r.reference;
  }
};

/// Which rows count, and of how many. The products of all of them give the fit; how strong the instruments are is asked
/// of the rows that the filters' cutoff needs.
struct InstrumentRows {
  const std::vector<RowRange>& ranges;
  Index lags;  ///< of the residuals' covariance, rows
  Index step;  ///< the first of so many holds all that they hold
};

/// From a position reference: [r̈ ṙ r 1], filtered as the motion is. From a force: the derivatives of
///   x̂ = (M_t s² + B_t s + K_t)⁻¹ F*,
/// with M_t, B_t, K_t of robot and limb together, found from F* itself by least squares and then twice by the
/// instruments of the pass before. What is instrumental about them is that they are made from F* alone: a nominal
/// impedance that is wrong costs strength, not truth (Söderström & Stoica 1983). Where its unit does not say what the
/// reference is, the stronger of both is taken.
/// @fails the trials hold no filtered reference; it never changes.
[[nodiscard]] Result<Instruments> make_instruments(const Regression& r, ReferenceQuantity quantity,
                                                   const InstrumentRows& rows);

/// How much of what a model leaves is a linear answer to the known perturbation that no inertia, damping and stiffness
/// gives: the residual on the instruments and on the reference as it was up to half a second before.
/// @param residuals  N×n of each model    @param step  of the rows, the first of so many is taken
/// @returns share of each column's power, model after model; what chance would give is subtracted
[[nodiscard]] Vector coherent_residual_fraction(const Regression& r, const Instruments& instruments,
                                                const std::vector<numeric::MatrixPart>& residuals,
                                                const std::vector<RowRange>& ranges, Index step);

}  // namespace mbk::identify
