#pragma once

#include "mbk/base/lti/positive_real.h"
#include "mbk/model/trial/teleoperation.h"
#include "mbk/teleop/two_port.h"

namespace mbk::teleop {

/// Absolute stability of a two-port: the terminated network is stable for every passive termination at both ports. By
/// Llewellyn's criterion (1952; theorem 4.1 of Dyck 2013), r_ij = Re m_ij(jω) and p = m₁₂ m₂₁ of any immittance matrix
/// m:
///   no pole has Re s > 0;  poles of m₁₁ and m₂₂ on the axis are simple, with positive residues;
///   r₁₁ ≥ 0,  r₂₂ ≥ 0,  2 r₁₁ r₂₂ − Re p ≥ 0,  4 r₁₁ r₂₂ (r₁₁ r₂₂ − Re p) − (Im p)² ≥ 0  for all ω > 0,
/// the last two of which are equivalent to 2 r₁₁ r₂₂ − Re p − |p| ≥ 0. Three requirements that the theorem does not
/// state are also checked: the axis includes ∞; m₁₂ and m₂₁ have no pole in the right half plane; and if the axis has a
/// pole, with residues k_ij, k₁₁ k₂₂ ≥ k₁₂ k₂₁ ([[1, 2], [2, 1]]/s passes all of the above, but port 1 is a spring of
/// −3 when port 2 is free to move). Everything is decided exactly, in rational arithmetic; only the returned
/// frequencies and values are rounded.
/// @returns  each condition with the bands in which it is violated and the worst frequency there
[[nodiscard]] AbsoluteStability llewellyn(const TwoPort& two_port);

/// llewellyn(two_port).holds(), but faster.
[[nodiscard]] bool is_absolutely_stable(const TwoPort& two_port);

/// Only its first two lines, and the residues seen at port 1: the conditions that m₁₁ − a and m₂₂ − b share with m, for
/// any numbers a and b.
[[nodiscard]] bool has_passive_poles(const lti::RationalMatrix& m);

/// 2 r₁₁ r₂₂ − Re p − |p| over 2 |r₁₁ r₂₂| + |Re p| + |p|, from −1 to 1, with the sign of the third condition.
struct ConditionValues {
  double r11 = 0, r22 = 0, third = 0;
};
/// In double; not finite at a pole, and `third` is NaN where 0/0.
[[nodiscard]] ConditionValues condition_values(const Eigen::MatrixXcd& immittance);

}  // namespace mbk::teleop
