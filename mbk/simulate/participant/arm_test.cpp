#include "mbk/simulate/participant/arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mbk/base/numeric/dense.h"
#include "tests/support/allocations.h"

namespace mbk::participant {
namespace arm_test {

constexpr double kTick = 1e-3;
const Vector2d kHome(0.30, -0.05);

/// Ticks while the hand rests at a place.
void wait(Arm& arm, const Vector2d& hand, int ticks) {
  for (int i = 0; i < ticks; ++i) arm.tick(i * kTick, kTick, {hand}, {0.0, 0.0});
}

TEST(Arm, IsItsLimbLessVoluntaryForceAndRemnant) {
  Arm arm = Arm::create(rigid_arm_options(), kTick).value();
  const HandState<2> hand = {kHome + Vector2d(0.02, -0.01), {0.1, 0.05}};
  wait(arm, hand.position, 1000);
  ASSERT_GT(arm.voluntary_force().norm(), 1.0);
  TwoLinkArm limb = TwoLinkArm::create({}).value();
  limb.scale(1.0 + 6.0 * 0.4, 1.0 + 3.0 * 0.4);  // at rest c is 0.4
  const LoadDynamics<2> passive = limb.dynamics(hand), all = arm.dynamics(hand);
  EXPECT_EQ(all.inertia, passive.inertia);
  EXPECT_LT((passive.bias - all.bias - arm.voluntary_force() - arm.remnant()).norm(), 1e-12);
}

TEST(Arm, PushesBackToItsTarget) {
  Arm arm = Arm::create(rigid_arm_options(), kTick).value();
  const Vector2d displacement(0.02, -0.01);
  wait(arm, kHome + displacement, 3000);
  EXPECT_LT(arm.voluntary_force().dot(arm.impedance(kHome).K * displacement), 0.0);
}

TEST(Arm, RelaxedHasNoWillAndNoCocontraction) {
  Arm arm = Arm::create(relaxed_arm_options(), kTick).value();
  for (int i = 0; i < 3000; ++i) arm.tick(i * kTick, kTick, {kHome + Vector2d(0.02, 0.0), {0.3, 0.0}}, {5.0, 5.0});
  EXPECT_EQ(arm.voluntary_force(), Vector2d(0.0, 0.0));
  EXPECT_EQ(arm.cocontraction(), 0.0);
  EXPECT_GT(arm.remnant().norm(), 0.0);
  const impedance::Model truth = TwoLinkArm::create({}).value().impedance(kHome);
  EXPECT_EQ(impedance::stacked(arm.impedance(kHome)), impedance::stacked(truth));
}

TEST(Arm, MayHaveALinearLimb) {
  const impedance::Model hand = {Matrix2d::Identity(), 5.0 * Matrix2d::Identity(), 90.0 * Matrix2d::Identity(), kHome};
  ArmOptions options = rigid_arm_options();
  options.limb = hand;
  options.remnant = {.floor = 0.0, .per_force = 0.0};
  Arm arm = Arm::create(options, kTick).value();
  EXPECT_LT((arm.impedance(kHome).K - (1.0 + 6.0 * 0.4) * hand.K).norm(), 1e-12);
  EXPECT_LT((arm.impedance(kHome).B - (1.0 + 3.0 * 0.4) * hand.B).norm(), 1e-12);
  const Vector2d away(0.01, 0.0);
  EXPECT_LT((arm.dynamics({kHome + away}).bias - 3.4 * 90.0 * away).norm(), 1e-12);
}

TEST(Arm, SameSeedSamePerson) {
  const auto force = [](std::uint64_t seed) {
    ArmOptions options = rigid_arm_options();
    options.seed = seed;
    Arm arm = Arm::create(options, kTick).value();
    wait(arm, kHome + Vector2d(0.02, -0.01), 1000);
    return Vector2d(arm.voluntary_force() + arm.remnant());
  };
  EXPECT_EQ(force(1), force(1));
  EXPECT_NE(force(1), force(2));
}

TEST(Arm, DoesNotAllocateInItsTicks) {
  const long before_making = testing_support::allocations();
  Arm arm = Arm::create(rigid_arm_options(), kTick).value();
  EXPECT_GT(testing_support::allocations(), before_making);  // the counter counts
  const long before = testing_support::allocations();
  Vector2d sum = {0.0, 0.0};
  for (int i = 0; i < 2000; ++i) {
    const HandState<2> hand = {kHome + Vector2d(0.02, -0.01), {0.1, 0.0}};
    arm.tick(i * kTick, kTick, hand, {1.0, 0.0});
    sum += arm.dynamics(hand).bias;
  }
  EXPECT_EQ(testing_support::allocations(), before) << sum;
}

TEST(Participants, HaveThePublishedImpedanceAndAnInertiaNearIt) {
  const double published[6][9] = {{1.326, 1.883, -0.935, 5.76, 10.56, -2.14, 42.4, 125.3, -28.6},
                                  {1.301, 1.357, -0.807, 5.78, 9.10, -2.57, 45.2, 112.1, -34.2},
                                  {1.536, 1.717, -0.958, 6.01, 10.48, -3.34, 39.5, 108.3, -28.0},
                                  {1.419, 1.885, -1.025, 4.75, 9.56, -3.17, 36.6, 151.6, -43.3},
                                  {1.275, 2.082, -0.951, 4.80, 11.95, -2.54, 39.0, 165.1, -28.3},
                                  {1.105, 1.659, -0.770, 3.16, 8.21, -1.31, 22.7, 93.4, -23.7}};
  for (int number = 1; number <= 6; ++number) {
    const Arm arm = Arm::create(participant_options(number).value(), kTick).value();
    const impedance::Model hand = arm.impedance(kHome);
    const double* expected = published[number - 1];
    for (const Matrix& matrix : {hand.M, hand.B, hand.K}) {
      EXPECT_NEAR(matrix(0, 0), expected[0], 1e-10) << number;
      EXPECT_NEAR(matrix(1, 1), expected[1], 1e-10) << number;
      EXPECT_NEAR(matrix(0, 1), expected[2], 1e-10) << number;
      expected += 3;
    }
    const TwoLinkArm::Options options = participant_limb(number).value();
    const TwoLinkArm limb = TwoLinkArm::create(options).value();
    for (double away = -ChainInertia::kElbowRange; away <= ChainInertia::kElbowRange; away += 0.05) {
      const Matrix2d I = limb.inertia().matrix(Elbow::at(options.joints.elbow_angle + away));
      EXPECT_GT(numeric::symmetric_eigenvalues(I)[0], 1e-3) << number << ", elbow " << away << " off";
    }
  }
  EXPECT_NE(participant_options(7).error().message.find("participant 7"), std::string::npos);
}

}  // namespace arm_test
}  // namespace mbk::participant
