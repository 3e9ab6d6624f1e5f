#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/identification.h"

namespace mbk::identify {

/// How well the motion identifies the terms of the model.
/// @param Z N×(3n+1), [ẍ ẋ x 1]    @param Y N×n, −F_h    @param rank of the regressors, from the fit
[[nodiscard]] Excitation measure_excitation(const Matrix& Z, const Matrix& Y, const impedance::Model& model, int rank);

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
