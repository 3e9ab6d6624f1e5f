#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/perturbation/multisine.h"

namespace mbk::perturbation {

/// One experiment in which axes move at the same time: the lines, in ascending order, go to the axes in turn (first,
/// second, …, first, …), so that over every whole period the axes are uncorrelated at every delay. Each axis is
/// measured at its own lines; amplitudes and phases are unchanged, and `with_low_crest_phases` may follow on each axis.
/// @fails  fewer lines than axes.
[[nodiscard]] Result<std::vector<Multisine>> interleaved(const Multisine& signal, int axes = 2);

}  // namespace mbk::perturbation
