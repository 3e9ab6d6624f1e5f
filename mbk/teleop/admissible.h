#pragma once

#include <functional>

#include "mbk/base/core/result.h"
#include "mbk/base/lti/real_roots.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/two_port.h"

namespace mbk::teleop {

/// {k in [low, high]: the network at k is absolutely stable}, as intervals; nothing between two of them is missed.
/// Each condition is a polynomial f(X, k). The roots of f in X > 0 can appear, meet or vanish only where a leading or
/// last coefficient of its square-free part, its discriminant or its content is zero; poles can change side only where
/// the even and odd part of the denominator have a common root, and their residues only where a coefficient is zero.
/// These k are the real roots of resultants, found exactly; between two neighbours every k has the answer of one, which
/// is decided by llewellyn(). A boundary is an algebraic number. Where it is a fraction it is decided by itself. Where
/// not: it belongs to the set next to it, because the conditions are closed, unless a pole or residue changes there:
/// then whether it is included is left open, and so is a single boundary between two pieces that fail.
/// Values are rounded to double on output.
/// @fails  not usable: the network has no immittance; it has undamped poles other than 0 and ∞ for every k, whose
/// residues this does not follow. usage: low > high.
/// @param progress  is told how much of the work is done, about, from 0 to 1
[[nodiscard]] Result<AdmissibleSet> admissible_set(const PortEquations& equations, const Rational& low,
                                                   const Rational& high,
                                                   const std::function<void(double)>& progress = {});

}  // namespace mbk::teleop
