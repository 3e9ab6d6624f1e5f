#include "mbk/model/robot/friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace mbk::robot {
namespace {

const JointFriction kCoulomb{.viscous = 0.07, .coulomb = 0.1};
const JointFriction kStribeck{.viscous = 0.07, .coulomb = 0.1, .breakaway = 0.18};

TEST(JointFriction, OpposesTheMotionAlikeInBothDirections) {
  for (const JointFriction& friction : {JointFriction{.viscous = 0.065}, kCoulomb, kStribeck}) {
    EXPECT_EQ(friction.torque(0.0), 0.0);
    for (double speed = 1e-4; speed < 10.0; speed *= 1.7) {
      EXPECT_GT(friction.torque(speed), 0.0);
      EXPECT_EQ(friction.torque(-speed), -friction.torque(speed));
    }
  }
}

TEST(JointFriction, GrowsWithSpeedWhereThereIsNoStribeckEffect) {
  for (double speed = -3.0; speed < 3.0; speed += 0.001) {
    EXPECT_LT(kCoulomb.torque(speed), kCoulomb.torque(speed + 0.001)) << speed;
  }
}

TEST(JointFriction, IsOnlyViscousByDefault) {
  const JointFriction friction{.viscous = 0.065};
  for (const double speed : {-2.0, 0.001, 0.5}) EXPECT_DOUBLE_EQ(friction.torque(speed), 0.065 * speed);
}

TEST(JointFriction, AtSpeedTheDryPartIsCoulombs) {
  constexpr double kFast = 1.0;         // [rad/s]: 20 Stribeck velocities, 50 widths of the smoothed sign
  constexpr double kTolerance = 1e-12;  // [N·m]
  EXPECT_NEAR(kCoulomb.dry_torque(kFast), 0.1, kTolerance);
  EXPECT_NEAR(kStribeck.dry_torque(kFast), 0.1, kTolerance);
  EXPECT_NEAR(kStribeck.torque(kFast), 0.1 + 0.07 * kFast, kTolerance);
}

TEST(JointFriction, BreakawayStandsAboveCoulombAtLowSpeedAndIsNeverExceeded) {
  double highest = 0.0;
  for (double speed = 0.0; speed < 1.0; speed += 1e-4) highest = std::max(highest, kStribeck.dry_torque(speed));
  EXPECT_GT(highest, 1.2 * 0.1);
  EXPECT_LE(highest, 0.18);
  EXPECT_GT(kStribeck.dry_torque(0.03), kStribeck.dry_torque(0.2));  // and falls as the joint gets going
}

TEST(JointFriction, BreakawayBelowCoulombIsNone) {
  const JointFriction low{.coulomb = 0.1, .breakaway = 0.05};
  for (double speed = 0.0; speed < 0.5; speed += 0.01) {
    EXPECT_EQ(low.dry_torque(speed), (JointFriction{.coulomb = 0.1}.dry_torque(speed)));
  }
}

TEST(JointFriction, FollowsItsEquation) {
  const double speed = 0.04;
  const double expected =
      0.07 * speed + (0.1 + 0.08 * std::exp(-(speed * speed) / (0.05 * 0.05))) * std::tanh(speed / 0.02);
  EXPECT_DOUBLE_EQ(kStribeck.torque(speed), expected);
}

TEST(JointFriction, IsSmoothThroughStandstill) {
  constexpr double kStep = 1e-6;
  const double slope = (kStribeck.torque(kStep) - kStribeck.torque(-kStep)) / (2.0 * kStep);
  EXPECT_NEAR(slope, 0.07 + 0.18 / 0.02, 1e-6);  // [N·m·s/rad]: b + f_s/ω_t
}

}  // namespace
}  // namespace mbk::robot
