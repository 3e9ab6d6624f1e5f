#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::explore {

/// A displacement of the reference from where it rests to another place where it is held.
struct ReferenceRamp {
  Index rest_begin = 0;  ///< first row of the rest before
  Index onset = 0;       ///< last row at rest
  Index held = 0;        ///< first row at the new place
  Index hold_end = 0;    ///< behind the last row there
  Vector commanded;      ///< from rest to the new place, n [m or rad]
};

/// Ramps away from home, the place at which the reference rests most often; ways back are none. The reference rests
/// where it keeps its value for `shortest_rest` seconds, up to 10⁻⁵ of its range.
/// @param reference  N×n    @param sample_time  T [s]    @param shortest_ramp  [s]; faster ones are steps, and no ramps
[[nodiscard]] std::vector<ReferenceRamp> find_ramps(const Matrix& reference, double sample_time, double shortest_ramp,
                                                    double shortest_rest = 0.04);

}  // namespace mbk::explore
