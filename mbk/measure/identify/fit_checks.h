#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/model/trial/identification.h"

namespace mbk::identify {

/// What of a regression the excitation follows from.
struct Spread {
  Matrix motion;  ///< 3n×3n, covariance of [ẍ ẋ x]
  Vector force;   ///< n, variance of each axis
};

/// @param Z N×(3n+1), [ẍ ẋ x 1]    @param Y N×n, −F_h
[[nodiscard]] Spread spread_of(const numeric::MatrixPart& Z, const numeric::MatrixPart& Y);

/// How well the motion identifies the terms of the model.   @param rank of the regressors, from the fit
[[nodiscard]] Excitation measure_excitation(const Spread& spread, const impedance::Model& model, int rank);

/// Adds what the user must know about an otherwise complete Identification, and decides whether it is usable: the
/// regressors can be distinguished, the symmetric parts of M and K are positive definite, and the model explains more
/// of the held-out force than its mean does; instrumental variables are strong, and the limb does not respond to each
/// pulse with a force that they take for mechanics.
void add_warnings(Identification& identification);

/// Warns of a model by least squares that instruments contradict, where those hold: the limb or noise acts back on the
/// motion, and least squares takes that for mechanics.
void warn_of_closed_loop(const Identification& instrumental, const Disagreement& disagreement,
                         Identification& least_squares);

}  // namespace mbk::identify
