#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::explore {

/// Samples [begin, end) in which a signal repeats itself.
struct PeriodicPart {
  Index begin = 0, end = 0;
};

/// The least number of samples p after which signals repeat themselves: of the delays at which
///   d(p) = Σ |x[i + p] − x[i]|² / Σ (|x[i]|² + |x[i + p]|²)
/// has a minimum after it was above ½ (0: the same, 1: unrelated, 2: inverted), over all columns, each of variance 1,
/// - exact: the least one at which half of all samples return to within a thousandth of the column's range: a signal
///   that was commanded, also where it is changed from one realisation to the next;
/// - else the least one whose d is below 0.1 and near the least of all: one that was measured.
/// @param signals  N×n    @returns nothing where there is none up to N/2, or nothing moves
[[nodiscard]] std::optional<Index> find_period(const Matrix& signals, bool exact);

/// The longest parts in which a commanded signal returns after `period` samples to within a thousandth of its range,
/// each of two periods or more: one for each realisation.
[[nodiscard]] std::vector<PeriodicPart> periodic_parts(const Matrix& signals, Index period);

}  // namespace mbk::explore
