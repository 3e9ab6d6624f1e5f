#include "mbk/simulate/participant/reaching.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "mbk/simulate/participant/arm.h"
#include "tests/support/allocations.h"

namespace mbk::participant {
namespace reaching_test {

constexpr double kTick = 1e-3;

Reaching make(const Reaching::Options& options, std::uint64_t seed = 1) {
  return Reaching::create(options, seed, 0).value();
}

TEST(Reaching, WithoutSpreadIsAMinimumJerkPathThereAndBack) {
  const Reaching reaching = make({.latest = 0.0, .duration_spread = 0, .length_spread = 0, .bend = 0, .end_spread = 0});
  const Reaching::Options& o = reaching.options();
  for (const double s : {0.1, 0.3, 0.5, 0.9}) {
    const double share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    const double begin = o.first + 2.0 * o.interval;
    EXPECT_LT((reaching.at(begin + s * o.duration).value - o.start - share * o.reach).norm(), 1e-12);
    EXPECT_LT(
        (reaching.at(begin + o.duration + o.stay + s * o.way_back).value - o.start - (1 - share) * o.reach).norm(),
        1e-12);
  }
  EXPECT_EQ(reaching.at(0.5).value, o.start);
  EXPECT_EQ(reaching.at(1e4).value, o.start);
}

TEST(Reaching, HasDerivativesThatAreSlopes) {
  const Reaching reaching = make({.bend = 0.02, .end_spread = 0.02}, 7);
  constexpr double kStep = 1e-6;
  for (double t = 3.0; t < 15.0; t += 0.0173) {
    const auto now = reaching.at(t), after = reaching.at(t + kStep), before = reaching.at(t - kStep);
    EXPECT_LT((now.first - (after.value - before.value) / (2.0 * kStep)).norm(), 1e-5) << t;
    EXPECT_LT((now.second - (after.first - before.first) / (2.0 * kStep)).norm(), 1e-3) << t;
  }
}

TEST(Reaching, VariesAsMuchAsItIsTold) {
  const Reaching reaching = make(
      {.reaches = 2000, .latest = 0.0, .duration_spread = 0, .length_spread = 0.04, .bend = 0.0, .end_spread = 0.005});
  const Reaching::Options& o = reaching.options();
  Eigen::Vector2d sum = {0.0, 0.0}, squares = {0.0, 0.0};
  for (int i = 0; i < o.reaches; ++i) {
    const Eigen::Vector2d end = reaching.at(o.first + i * o.interval + o.duration + 0.5 * o.stay).value - o.start;
    sum += end;
    squares += (end - o.reach).cwiseAbs2();
  }
  EXPECT_NEAR(sum.y() / o.reaches, 0.25, 0.001);
  EXPECT_NEAR(std::sqrt(squares.x() / o.reaches), 0.005, 0.0004);
  EXPECT_NEAR(std::sqrt(squares.y() / o.reaches), 0.010, 0.0008);
}

TEST(Reaching, RefusesWhatItCannotDo) {
  EXPECT_FALSE(Reaching::create({.reach = {0.0, 0.0}}, 1, 0));
  EXPECT_FALSE(Reaching::create({.reaches = -1}, 1, 0));
  EXPECT_FALSE(Reaching::create({.duration = 0.0}, 1, 0));
  EXPECT_FALSE(Reaching::create({.interval = 1.5}, 1, 0));
  EXPECT_FALSE(Reaching::create({.bend = -0.001}, 1, 0));
}

TEST(Arm, ThatReachesStaysOnItsWayWhereTheRobotIsWhatItTakesItFor) {
  ArmOptions options = relaxed_arm_options();
  options.remnant.floor = 0.0;
  options.reaching = Reaching::Options{.reach = {0.0, 0.08}, .carried_mass = 1.3};
  const Reaching meant = Reaching::create(*options.reaching, options.seed, 4).value();
  Arm arm = Arm::create(options, kTick).value();
  for (double t = 3.0; t < 6.0; t += 0.1) {
    const auto now = meant.at(t);
    arm.tick(t, kTick, {now.value, now.first}, {0.0, 0.0});
    const LoadDynamics<2> dynamics = arm.dynamics({now.value, now.first});
    // F_h = −(Λ ẍ + h) = m_c ẍ
    EXPECT_LT((dynamics.inertia * now.second + dynamics.bias + 1.3 * now.second).norm(), 1e-9) << t;
  }
}

TEST(Arm, ThatReachesIsPulledBackToItsWayByItsStiffness) {
  ArmOptions options = relaxed_arm_options();
  options.remnant.floor = 0.0;
  options.reaching = Reaching::Options{};
  const Eigen::Matrix2d K = (Eigen::Matrix2d() << 150.0, -55.0, -75.0, 330.0).finished();
  options.limb = impedance::Model{1.5 * Eigen::Matrix2d::Identity(), 10.0 * Eigen::Matrix2d::Identity(), K,
                                  options.reaching->start};
  const Reaching meant = Reaching::create(*options.reaching, options.seed, 4).value();
  Arm arm = Arm::create(options, kTick).value();
  const double t = 3.6;
  const auto now = meant.at(t);
  arm.tick(t, kTick, {now.value, now.first}, {0.0, 0.0});
  const Eigen::Vector2d away(0.005, -0.003);
  const Eigen::Vector2d change =
      arm.dynamics({now.value + away, now.first}).bias - arm.dynamics({now.value, now.first}).bias;
  EXPECT_LT((change - K * away).norm(), 1e-9);
  EXPECT_LT((arm.impedance(now.value).x0 - now.value).norm(), 1e-12);
}

TEST(Arm, ThatReachesDoesNotHoldAPlaceBesides) {
  ArmOptions options = rigid_arm_options();
  options.reaching = Reaching::Options{};
  EXPECT_FALSE(Arm::create(options, kTick));
}

TEST(Arm, OfTwoLinksRefusesATargetOutOfItsReach) {
  ArmOptions options = relaxed_arm_options();
  options.reaching = Reaching::Options{.reach = {0.0, 0.25}};
  EXPECT_FALSE(Arm::create(options, kTick));
  options.reaching->reach = {0.0, 0.08};
  EXPECT_TRUE(Arm::create(options, kTick));
}

TEST(Arm, ThatReachesDoesNotAllocate) {
  ArmOptions options = relaxed_arm_options();
  options.reaching = Reaching::Options{.reach = {0.0, 0.08}};
  Arm arm = Arm::create(options, kTick).value();
  const long before = testing_support::allocations();
  for (int i = 0; i < 5000; ++i) arm.tick(i * kTick, kTick, {options.reaching->start}, {0.0, 0.0});
  EXPECT_EQ(testing_support::allocations(), before);
}

}  // namespace reaching_test
}  // namespace mbk::participant
