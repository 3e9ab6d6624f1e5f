#pragma once

#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/two_port.h"

namespace mbk::teleop {

/// The largest a for which the network stays stable when the termination at `port` has Re z ≥ −a and the other is
/// passive (theorem 4.2): the smallest value over all ω of
///   r_ii − (Re p + |p|)/(2 r_jj),
/// where the poles are those of a passive network and r_jj ≥ 0. Its minima are sought in floating point, and only in
/// bands in which a value is proven to fail; both ends of the result are decided exactly, as in is_absolutely_stable().
/// They are 2⁻⁵⁰ of their size apart, or 2⁻⁵⁰ N·s/m where that is more. A fraction with a small denominator that is the
/// largest is found as such.
/// @param equations  taken at k = 0
/// @returns  exists: false where no a of up to 2⁶⁴ N·s/m is stable or all are
[[nodiscard]] LargestShortage largest_shortage(const PortEquations& equations, Port port);

}  // namespace mbk::teleop
