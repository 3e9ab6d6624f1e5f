#pragma once

#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/two_port.h"

namespace mbk::teleop {

/// The largest a for which the network stays stable when the termination at `port` has Re z ≥ −a and the other is
/// passive (theorem 4.2): the smallest value over all ω of
///   r_ii − (Re p + |p|)/(2 r_jj),
/// where the poles are those of a passive network and r_jj ≥ 0. Its minima are searched in floating point, and only in
/// bands in which a value is proven to fail; both ends of the result are decided exactly, as in is_absolutely_stable().
/// Their distance is 2⁻⁵⁰ of their size, or 2⁻⁵⁰ N·s/m if that is more. If the largest value is a fraction with a small
/// denominator, it is found exactly.
/// @param equations  evaluated at k = 0
/// @returns  exists: false if no a up to 2⁶⁴ N·s/m is stable, or if all are
[[nodiscard]] LargestShortage largest_shortage(const PortEquations& equations, Port port);

}  // namespace mbk::teleop
