#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/architectures.h"

namespace mbk::teleop {

/// The conditions of llewellyn() for a teleoperator with exact delays, D = e^(−jωT), which are not rational functions.
/// Conditions on the axis are computed in double on the grid only: violations between two points are not detected.
/// Conditions on poles are decided exactly: with |C₂ C₃| < |(1 + C₅)(1 + C₆)| the delay adds none in the right half
/// plane, and at 0 it is 1.
/// @param a  shortage of passivity of the termination at `port` [N·s/m]
/// @param sample_time  the controllers' [s], as in Teleoperator::with_exact_delay; the poles are those without sampling
/// @fails  not usable: the exchanged forces add poles, |C₂ C₃| ≥ |(1 + C₅)(1 + C₆)|.
[[nodiscard]] Result<AbsoluteStability> llewellyn_on_grid(const Teleoperator& teleoperator, const FrequencyGrid& grid,
                                                          Port port = Port::one, const Rational& a = 0,
                                                          double sample_time = 0.0);

/// inf over the grid of r_ii − (Re p + |p|)/(2 r_jj) in the z form: the largest shortage there.
/// @fails  as above
[[nodiscard]] Result<LargestShortage> largest_shortage_on_grid(const Teleoperator& teleoperator,
                                                               const FrequencyGrid& grid, Port port);

/// @fails  not usable: |C₂ C₃| ≥ |(1 + C₅)(1 + C₆)|, with which true delays add poles.
[[nodiscard]] Result<void> check_poles(const Teleoperator& teleoperator);

/// The grid's frequencies, evenly spaced in the logarithm.
[[nodiscard]] std::vector<RadPerSec> frequencies(const FrequencyGrid& grid);

}  // namespace mbk::teleop
