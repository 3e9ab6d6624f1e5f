#pragma once

#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/force_comparison.h"

namespace mbk::analyse {

/// One segment without a break, evenly sampled.
struct ForcePair {
  Matrix estimated;       ///< N×n, F_h [N]
  Matrix measured;        ///< N×n, F_h [N]
  Matrix joint_velocity;  ///< N×m, of the joints, or of the hand [rad/s or m/s]
};

struct ForceComparisonOptions {
  double rest_speed = 0.02;        ///< a joint that is not faster rests [rad/s or m/s] ≥ 0
  double reversal_window = 0.025;  ///< to each side of a reversal [s] ≥ 0
  double longest_lag = 0.1;        ///< that is tried, earlier and later [s] ≥ 0
};

/// Compares an estimated force with a measured one, row by row; rows of several segments count together.
/// A joint reverses where its velocity crosses from one side of ±rest_speed to the other: at the change of sign in
/// between, or the middle one of several. If it stays within ±rest_speed longer than twice the window, it rests; this
/// is not a reversal. The lag is that of the largest correlation, of which a parabola through the three largest gives
/// fractions of a row. The same measured rows are used at every lag: those with longest_lag before and after them in
/// their segment.
/// @fails  usage: an option or the sample time is out of its range; data: shapes differ, a value is not finite (the
/// first is named), or there are fewer than two rows.
[[nodiscard]] Result<ForceComparison> compare_forces(const std::vector<ForcePair>& segments, double sample_time,
                                                     const ForceComparisonOptions& options = {});

}  // namespace mbk::analyse
