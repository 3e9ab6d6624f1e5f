#pragma once

#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/reliability/comparison.h"

namespace mbk::reliability {

/// Chance that a two-sided t test at `level` finds a standardised difference d, by the noncentral t:
///   P(|T| > t(1 − α/2; ν)),  T ~ t(ν, d√ñ);  unpaired ν = 2n − 2, ñ = n/2; paired ν = n − 1, ñ = n
/// @param people ≥ 2, in each group, or pairs
[[nodiscard]] double power_of_t_test(double d, int people, Pairing pairing, double level = 0.05);

/// The fewest people, in each group, or pairs, with which that chance is at least `power`.
/// @param d  over the standard deviation of one person's value, or of the differences where paired
/// @fails  usage: d is 0 or not finite; power or level is not in (0, 1), or power is not above level; more than 10⁷.
[[nodiscard]] Result<int> people_for_effect(double d, double power, Pairing pairing, double level = 0.05);

/// Variances by which numbers differ [unit², all the same]: as a mixed model gives them.
struct VarianceComponents {
  double participant = 0, session = 0, residual = 0;
};

}  // namespace mbk::reliability
