#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/model/trial/identification.h"

namespace mbk::identify {

/// Moments of a regression from which the excitation is computed.
struct Spread {
  Matrix motion;  ///< 3n×3n, covariance of [ẍ ẋ x]
  Vector force;   ///< n, variance of each axis
};

/// @param Z N×(3n+1), [ẍ ẋ x 1]    @param Y N×n, −F_h
[[nodiscard]] Spread spread_of(const numeric::MatrixPart& Z, const numeric::MatrixPart& Y);

/// How well the motion identifies the terms of the model.   @param rank of the regressors, from the fit
[[nodiscard]] Excitation measure_excitation(const Spread& spread, const impedance::Model& model, int rank);

/// Adds warnings to an otherwise complete Identification and decides whether it is usable: the regressors are linearly
/// independent, the symmetric parts of M and K are positive definite, and the model explains more of the held-out force
/// than its mean does; instruments are strong, and the limb does not respond to each pulse with a force that they would
/// attribute to mechanics.
void add_warnings(Identification& identification);

/// Warns if valid instrumental variables contradict the least-squares model: the limb or noise acts back on the motion,
/// which biases least squares.
void warn_of_closed_loop(const Identification& instrumental, const Disagreement& disagreement,
                         Identification& least_squares);

}  // namespace mbk::identify
