#pragma once

#include "mbk/base/core/result.h"
#include "mbk/model/perturbation/multisine.h"

namespace mbk::perturbation {

/// Two axes that move at the same time. Over whole periods they are exactly uncorrelated at every delay if they have no
/// common line.
struct AxisPair {
  Multisine first;
  Multisine second;

  /// Both axes times a factor.
  [[nodiscard]] AxisPair scaled(double factor) const { return {first.scaled(factor), second.scaled(factor)}; }
};

/// One experiment: the lines, in ascending order, go to the axes in turn (first, second, first, …), so that the axes
/// are uncorrelated over every whole period. Each axis is measured at its own lines; amplitudes and phases are
/// unchanged, and `with_low_crest_phases` may follow on each axis.
/// @fails  fewer than two lines.
[[nodiscard]] Result<AxisPair> interleaved(const Multisine& signal);

}  // namespace mbk::perturbation
