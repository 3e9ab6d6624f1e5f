#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mbk/base/core/words.h"

namespace mbk {

/// On which side of the line from shoulder to hand the elbow is, seen from above; `elbow` in a recording's metadata.
enum class ElbowSide { right, left };

[[nodiscard]] constexpr auto word_table(ElbowSide) {
  using enum ElbowSide;
  return std::to_array<Word<ElbowSide>>({{right, "right"}, {left, "left"}});
}

/// Posture of limb or machine during the measurement, as points of a polyline.
struct ArmPosture {
  enum class Of {
    arm,    ///< shoulder, elbow, hand
    robot,  ///< base, elbow, hand
    hand,   ///< the hand alone
  };
  Of of = Of::hand;
  std::vector<Eigen::Vector2d> points;  ///< base frame [m]; the hand is the last
  std::string note;                     ///< why only the hand is known, if the recording has invalid data on the rest
};

[[nodiscard]] constexpr auto word_table(ArmPosture::Of) {
  using enum ArmPosture::Of;
  return std::to_array<Word<ArmPosture::Of>>({{arm, "arm"}, {robot, "robot"}, {hand, "hand"}});
}

}  // namespace mbk
