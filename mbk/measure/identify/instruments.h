#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/measure/identify/regression.h"

namespace mbk::identify {

/// The motion that the known perturbation alone causes: the instruments of the regression, N×(3n+1), in the same rows
/// as its regressors [ẍ ẋ x 1].
struct Instruments {
  Matrix response;  ///< response of a nominal limb to the force, [motion 1]; empty if the instruments are the reference
  ReferenceQuantity from = ReferenceQuantity::unknown;  ///< assumed quantity of the reference
  Vector strength;                                      ///< 3n, conditional first-stage F of ẍ, ẋ, x
  Matrix gram = {};                                     ///< [R Z Y]ᵀ[R Z Y] of the rows used

  /// R, with the motion relative to its mean in the rows used.
  [[nodiscard]] const Matrix& columns(const Regression& r) const {
    return response.size() > 0 ? response : r.reference;
  }
};

/// Rows used. All of them give the fit; instrument strength is computed on the rows that the low-pass filter leaves
/// independent.
struct InstrumentRows {
  const std::vector<RowRange>& ranges;
  Index lags;  ///< of the residuals' covariance, rows
  Index step;  ///< every step-th row contains all information
};

/// From a position reference: [r̈ ṙ r 1], filtered as the motion is. From a force: the derivatives of
///   x̂ = (M_t s² + B_t s + K_t)⁻¹ F*,
/// with M_t, B_t, K_t of robot and limb together, found from F* itself by least squares and then twice by the
/// instruments of the pass before. They are valid instruments because they are computed from F* alone: a wrong
/// nominal impedance reduces their strength but causes no bias (Söderström & Stoica 1983). If the unit of the reference
/// does not show its quantity, the stronger of both is used.
/// @fails the trials contain no filtered reference; it is constant.
[[nodiscard]] Result<Instruments> make_instruments(const Regression& r, ReferenceQuantity quantity,
                                                   const InstrumentRows& rows);

/// Perturbation-coherent residual fraction: the share of the residual of a model that responds linearly to the known
/// perturbation, from a regression on the instruments and on the reference up to half a second before.
/// @param residuals  N×n of each model    @param step  every step-th row is used
/// @returns share of the power of each column, for each model, minus the expectation by chance
[[nodiscard]] Vector coherent_residual_fraction(const Regression& r, const Instruments& instruments,
                                                const std::vector<numeric::MatrixPart>& residuals,
                                                const std::vector<RowRange>& ranges, Index step);

}  // namespace mbk::identify
