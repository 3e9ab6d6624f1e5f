#pragma once

#include <functional>

#include "mbk/base/core/result.h"
#include "mbk/base/lti/real_roots.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/two_port.h"

namespace mbk::teleop {

/// {k in [low, high]: the network at k is absolutely stable}, as intervals; none is missed.
/// Each condition is a polynomial f(X, k). The roots of f in X > 0 can appear, meet or vanish only where a leading or
/// last coefficient of its square-free part, its discriminant or its content is zero; poles can change side only where
/// the even and odd part of the denominator have a common root, and their residues only where a coefficient is zero.
/// These k are the real roots of resultants, found exactly; between two neighbours all k have the same answer, which
/// llewellyn() decides for one. A boundary is an algebraic number. If it is a fraction, it is decided separately.
/// Otherwise it belongs to the adjacent set, because the conditions are closed, unless a pole or residue changes there:
/// then its inclusion is undecided, as is a single boundary between two failing pieces. Values are rounded to double on
/// output.
/// @fails  not usable: the network has no immittance; it has undamped poles other than 0 and ∞ for every k, whose
/// residues are not analysed. usage: low > high.
/// @param progress  receives the approximate completed fraction, from 0 to 1
[[nodiscard]] Result<AdmissibleSet> admissible_set(const PortEquations& equations, const Rational& low,
                                                   const Rational& high,
                                                   const std::function<void(double)>& progress = {});

}  // namespace mbk::teleop
