#pragma once

#include <Eigen/Core>
#include <vector>

#include "mbk/base/numeric/random.h"

namespace mbk::perturbation {

/// Unit vector at the angle 2π k/n from +x, exact along the axes, base frame.   @param n ≥ 1    @param k 0 … n − 1
[[nodiscard]] Eigen::Vector2d direction_on_circle(int k, int n);

/// Unit vector along one of the 26 combinations of −1, 0 and 1 in space other than zero, base frame.   @param k 0 … 25
inline constexpr int kDirectionsInSpace = 26;
[[nodiscard]] Eigen::Vector3d direction_in_space(int k);

/// Each of 0 … directions − 1, `repetitions` times, in random order (Fisher & Yates).   @param directions, repetitions
/// ≥ 1
[[nodiscard]] std::vector<int> shuffled_directions(int directions, int repetitions, numeric::Random& random);

}  // namespace mbk::perturbation
