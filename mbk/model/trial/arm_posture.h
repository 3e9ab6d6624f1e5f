#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mbk {

/// Where limb or machine stood while it was measured, as points to draw lines between.
struct ArmPosture {
  enum class Of {
    arm,    ///< shoulder, elbow, hand
    robot,  ///< base, elbow, hand
    hand,   ///< the hand alone
  };
  Of of = Of::hand;
  std::vector<Eigen::Vector2d> points;  ///< base frame [m]; the hand is the last
  std::string note;                     ///< why it is no more than that, where the recording meant to say more
};

[[nodiscard]] constexpr const char* text(ArmPosture::Of of) {
  switch (of) {
    case ArmPosture::Of::arm:
      return "arm";
    case ArmPosture::Of::robot:
      return "robot";
    case ArmPosture::Of::hand:
      return "hand";
  }
  return "unknown";
}

}  // namespace mbk
