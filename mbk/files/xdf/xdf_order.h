#pragma once

#include <vector>

#include "mbk/base/core/linear_algebra.h"

namespace mbk::recording {

/// The order of samples by their time stamps, if a file contains groups of them out of order.
///
/// Stamps are cut into runs where an interval is off the median one by more than half of it and by more than six
/// standard deviations of all intervals. Runs are sorted by their first stamp. If that moves runs, the new order is
/// kept only if they fit together: intervals between them are off by a quarter, in all, of what they were, and on
/// average by a quarter of the length of a run; runs overlap by no more than a fifth of what intervals were off; and
/// that is five times as far as stamps which still run backward do. Jittering stamps, a clock that was set back and
/// duplicate samples do not fit and keep the file order.
///
/// @param stamps  [s], finite, of samples that were taken evenly
/// @returns  for each position the index of the sample in the file; empty if the order is correct
[[nodiscard]] std::vector<Index> order_by_stamps(const Vector& stamps);

}  // namespace mbk::recording
