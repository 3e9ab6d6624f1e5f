#include "mbk/measure/explore/servo_displacement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/measure/explore/test_ramps.h"

namespace mbk::explore {
namespace servo_displacement_test {

constexpr double kT = 0.001;
const Matrix kStiffness = Matrix{{150.0, -55.0}, {-75.0, 330.0}};

/// Reaches that differ in one number, the length: what they will do follows from what they did.
RecordedReach reach_of(double length, double noise, numeric::Random& random) {
  RecordedReach reach;
  reach.position = reach.force_hand_on_robot = Matrix::Zero(800, 2);
  for (Index i = 0; i < 800; ++i) {
    const auto s = minimum_jerk_path(static_cast<double>(i) * kT - 0.05, 0.6);
    reach.position(i, 1) = length * s[0];
    reach.force_hand_on_robot(i, 0) = noise * random.normal();
    reach.force_hand_on_robot(i, 1) = 0.5 * length * s[2] + noise * random.normal();
  }
  reach.trigger = 300;
  return reach;
}

std::vector<RecordedReach> undisturbed(int count, double spread, double noise, std::uint64_t seed) {
  numeric::Random random(seed);
  std::vector<RecordedReach> all;
  for (int i = 0; i < count; ++i) all.push_back(reach_of(0.25 * (1.0 + spread * random.normal()), noise, random));
  return all;
}

/// A massless spring hand that is pulled away by 8 mm, at once, for as long as the record lasts.
std::vector<DisplacedReach> displaced(int count, int directions, double spread, double noise, std::uint64_t seed) {
  numeric::Random random(seed, 1);
  std::vector<DisplacedReach> all;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i % directions) / directions;
    const Vector d = 0.008 * Vector{{std::cos(angle), std::sin(angle)}};
    RecordedReach reach = reach_of(0.25 * (1.0 + spread * random.normal()), noise, random);
    for (Index k = reach.trigger + 1; k < reach.position.rows(); ++k) {
      reach.position.row(k) += d.transpose();
      reach.force_hand_on_robot.row(k) -= (kStiffness * d).transpose();
    }
    all.push_back({reach, d});
  }
  return all;
}

TEST(ReachPrediction, SaysWhatAReachWillDoFromWhatItDid) {
  const auto prediction = ReachPrediction::create(undisturbed(20, 0.1, 0.0, 1), kT);
  ASSERT_TRUE(prediction) << prediction.error().line();
  EXPECT_GE(prediction->components(), 1);
  EXPECT_LT(prediction->left_out_error().maxCoeff(), 1e-9);
  numeric::Random random(7);
  const RecordedReach other = reach_of(0.33, 0.0, random);
  const auto predicted = prediction->predict(other);
  ASSERT_TRUE(predicted);
  EXPECT_NEAR((predicted->position - other.position.middleRows(300, 300)).norm(), 0.0, 1e-8);
  EXPECT_NEAR((predicted->force_hand_on_robot - other.force_hand_on_robot.middleRows(300, 300)).norm(), 0.0, 1e-7);
}

TEST(ReachPrediction, WithoutComponentsIsTheMeanFromTheTriggerOn) {
  const auto reaches = undisturbed(9, 0.1, 0.0, 3);
  const auto prediction = ReachPrediction::create(reaches, kT, {.max_components = 0});
  ASSERT_TRUE(prediction);
  Matrix mean = Matrix::Zero(300, 2);
  for (const RecordedReach& one : reaches) {
    mean += (one.position.middleRows(300, 300).rowwise() - one.position.row(300)) / 9.0;
  }
  const auto predicted = prediction->predict(reaches.front());
  ASSERT_TRUE(predicted);
  EXPECT_NEAR((predicted->position - (mean.rowwise() + reaches.front().position.row(300))).norm(), 0.0, 1e-12);
  EXPECT_GT(prediction->left_out_error().maxCoeff(), 1e-3);
}

TEST(ReachPrediction, DoesNotSeeWhatFollowsTheTrigger) {
  const auto prediction = ReachPrediction::create(undisturbed(20, 0.1, 0.01, 1), kT);
  ASSERT_TRUE(prediction);
  numeric::Random random(7);
  RecordedReach reach = reach_of(0.3, 0.01, random);
  const auto before = prediction->predict(reach);
  reach.position.bottomRows(499).setConstant(7.0);
  reach.force_hand_on_robot.setZero();
  const auto after = prediction->predict(reach);
  ASSERT_TRUE(before && after);
  EXPECT_EQ(before->position, after->position);
}

TEST(ReachPrediction, RefusesReachesThatDoNotReachFarEnough) {
  const auto reaches = undisturbed(20, 0.1, 0.0, 1);
  EXPECT_FALSE(ReachPrediction::create({reaches.data(), 7}, kT));
  EXPECT_FALSE(ReachPrediction::create(reaches, kT, {.past = 0.35}));
  EXPECT_FALSE(ReachPrediction::create(reaches, kT, {.future = 0.6}));
  EXPECT_FALSE(ReachPrediction::create(reaches, 0.0));
  auto broken = reaches;
  broken[2].position(310, 0) = std::nan("");
  EXPECT_FALSE(ReachPrediction::create(broken, kT));
  const auto prediction = ReachPrediction::create(reaches, kT);
  ASSERT_TRUE(prediction);
  RecordedReach early = reaches.front();
  early.trigger = 100;
  EXPECT_FALSE(prediction->predict(early));
}

TEST(ServoDisplacement, FindsTheStiffnessOfAHandThatMovesExactly) {
  const auto found = servo_displacement_stiffness(undisturbed(20, 0.1, 0.0, 1), displaced(16, 8, 0.1, 0.0, 2), kT);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_NEAR((found->by.fit.K - kStiffness).norm(), 0.0, 1e-4);
  EXPECT_LT(found->by.motion_share, 1e-6);
  EXPECT_TRUE(found->verdict.usable);
  EXPECT_TRUE(found->verdict.warnings.empty());
}

TEST(ServoDisplacement, IsNotUsableWhereTheServoYieldsOrTheNoiseIsLarge) {
  const auto rest = undisturbed(20, 0.1, 0.01, 1);
  auto yielding = displaced(16, 8, 0.1, 0.01, 2);
  for (DisplacedReach& one : yielding) one.commanded *= 3.0;  // a third of it was made
  const auto soft = servo_displacement_stiffness(rest, yielding, kT);
  ASSERT_TRUE(soft);
  EXPECT_FALSE(soft->verdict.usable);
  const auto noisy = servo_displacement_stiffness(undisturbed(20, 0.1, 30.0, 1), displaced(16, 8, 0.1, 30.0, 2), kT);
  ASSERT_TRUE(noisy);
  EXPECT_FALSE(noisy->verdict.usable);
}

TEST(ServoDisplacement, IsMoreCertainByTheOwnPastThanByTheMeanOfOthers) {
  const auto rest = undisturbed(30, 0.1, 0.1, 1);
  const auto moved = displaced(32, 8, 0.1, 0.1, 2);
  const auto own = servo_displacement_stiffness(rest, moved, kT);
  ServoDisplacementOptions crude;
  crude.prediction.max_components = 0;
  const auto mean = servo_displacement_stiffness(rest, moved, kT, crude);
  ASSERT_TRUE(own && mean);
  EXPECT_LT(own->by.fit.standard_error.norm(), 0.5 * mean->by.fit.standard_error.norm());
  EXPECT_EQ(mean->by.components, 0);
}

TEST(ServoDisplacement, NeedsDirectionsForcesAndAPlateau) {
  const auto rest = undisturbed(20, 0.1, 0.01, 1);
  EXPECT_FALSE(servo_displacement_stiffness(rest, displaced(16, 2, 0.1, 0.01, 2), kT));
  EXPECT_FALSE(servo_displacement_stiffness(rest, displaced(4, 4, 0.1, 0.01, 2), kT));
  const auto moved = displaced(16, 8, 0.1, 0.01, 2);
  EXPECT_FALSE(servo_displacement_stiffness(rest, moved, kT, {.from = 0.2, .to = 0.4}));  // beyond the prediction
  EXPECT_FALSE(servo_displacement_stiffness(rest, moved, kT, {.from = 0.2, .to = 0.1}));
  auto without = rest;
  for (RecordedReach& one : without) one.force_hand_on_robot.resize(0, 0);
  EXPECT_FALSE(servo_displacement_stiffness(without, moved, kT));
}

}  // namespace servo_displacement_test
}  // namespace mbk::explore
