#pragma once

#include <vector>

#include "mbk/model/robot/kinematics.h"

namespace mbk::robot {

/// Joint angles over the whole workspace: a grid of `steps` by `steps` in the rectangle of the first two limits, less
/// what the third forbids and the corner where the links lie upon each other.
inline std::vector<Vector2d> postures(const JointLimits& limits, int steps) {
  constexpr double kInside = 0.01;  // [rad] away from every limit
  std::vector<Vector2d> grid;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      const double a = (i + 0.5) / steps, b = (j + 0.5) / steps;
      const Vector2d theta(limits.theta1_low + a * (limits.theta1_high - limits.theta1_low),
                           limits.theta2_low + b * (limits.theta2_high - limits.theta2_low));
      if (theta[0] - theta[1] + 1.5707963267948966 >= limits.smallest_opening + kInside) grid.push_back(theta);
    }
  }
  return grid;
}

}  // namespace mbk::robot
