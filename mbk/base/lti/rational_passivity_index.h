#pragma once

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/lti/rational.h"

namespace mbk::lti {

/// An extreme value over all frequencies. The two bounds are proven in rational arithmetic, but for the rounding of the
/// one at which the value is attained, and differ by 1e-10 of the largest value on the way.
struct PassivityIndex {
  double value = 0.0;
  double at_least = 0.0, at_most = 0.0;
  RadPerSec frequency;  ///< where it is attained or, at 0 and infinity, approached
};

/// ν, the largest number for which G(s) − ν I is positive real. Where G is stable and proper,
///   ν = inf over ω of λ_min(½ (G(jω) + G(jω)*)),
/// which is the input passivity index of MATLAB's getPassiveIndex. For Z = M s + B + K/s it is λ_min(½ (B + Bᵀ)).
/// @fails  not usable: it does not exist, because G has poles that no positive real matrix has; the message says which
/// condition of positive_real() they violate, and where; or its values are beyond the range of a double. usage: G is
/// empty or too large for positive_real().
[[nodiscard]] Result<PassivityIndex> input_passivity_index(const RationalMatrix& G);

/// ρ, the input passivity index of G⁻¹.
/// @fails  as that; not usable: G has no inverse.
[[nodiscard]] Result<PassivityIndex> output_passivity_index(const RationalMatrix& G);

/// R, the smallest number with ‖(I − G(jω)) w‖ ≤ R ‖(I + G(jω)) w‖ for all ω and w: the H∞ norm of
///   S = (I − G)(I + G)⁻¹.
/// R < 1 is an excess of passivity, R > 1 a shortage. G itself need not be stable.
/// @fails  not usable: it does not exist, because I + G has no inverse, a zero with Re s ≥ 0, or one at infinity.
/// usage: as above.
[[nodiscard]] Result<PassivityIndex> relative_passivity_index(const RationalMatrix& G);

}  // namespace mbk::lti
