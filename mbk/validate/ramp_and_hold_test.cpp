#include <gtest/gtest.h>

#include "mbk/validate/simulated_reaches.h"
#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace ramp_and_hold_test {

TEST(RampAndHoldStudy, RefutesNothingInAFewRuns) {
  const auto table = ramp_and_hold_study({.runs = 3, .seed = 5});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "ramp-and-hold");
  expect_nothing_refuted(*table);
}

TEST(ServoDisplacementStudy, RefutesNothingInAFewRuns) {
  const auto table = servo_displacement_study({.runs = 6, .seed = 5});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "servo-displacement");
  expect_nothing_refuted(*table);
}

/// Put back into its equation: on the plateau, without noise and where all reaches are alike, −ΔF_h = K d.
TEST(SimulatedReaches, HaveTheRestoringForceOfTheirStiffness) {
  SimulatedReaches hand;
  hand.duration_spread = hand.distance_spread = hand.bend = hand.drift = hand.noise = 0.0;
  hand.repetitions = 1;
  const auto reaches = simulate_reaches(hand, 1);
  ASSERT_TRUE(reaches) << reaches.error().line();
  const explore::RecordedReach& free = reaches->undisturbed.front();
  for (const explore::DisplacedReach& one : reaches->displaced) {
    const Index row = one.reach.trigger + 150;
    const Vector away = (one.reach.position.row(row) - free.position.row(row)).transpose();
    EXPECT_NEAR((away - one.commanded).norm(), 0.0, 1e-9);
    const Vector force = (free.force_hand_on_robot.row(row) - one.reach.force_hand_on_robot.row(row)).transpose();
    EXPECT_NEAR((force - hand.K * away).norm(), 0.0, 1e-3);
  }
}

}  // namespace ramp_and_hold_test
}  // namespace mbk::validation
