#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::explore {

/// A step or pulse of a reference.
struct Onset {
  Index sample = 0;  ///< first one at which the reference has left its rest
  Vector step;       ///< n, level after the movement less the level before it
};

/// Where a reference leaves a rest, in order. It rests where it keeps its value, to 10⁻⁶ of its range, for `rest`
/// samples or more. A movement that brings it back to where the one before it began is the end of a pulse and no onset.
/// @param reference N×n    @param rest ≥ 1
[[nodiscard]] std::vector<Onset> reference_onsets(const Matrix& reference, Index rest);

}  // namespace mbk::explore
