#include "mbk/simulate/participant/intermittent_controller.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

namespace mbk::participant {
namespace intermittent_controller_test {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kTick = 1e-3;
const Vector2d kTarget(0.30, -0.05);
const Matrix2d kStiffness = (Matrix2d() << 120.0, -80.0, -80.0, 380.0).finished();

IntermittentController::Options exact_options() {
  IntermittentController::Options options;
  options.position_gain = 1.4;
  options.random_error = 0.0;
  return options;
}

/// The voluntary force at each tick while hand and force are held.
std::vector<Vector2d> held(const IntermittentController::Options& options, const Vector2d& hand, const Vector2d& force,
                           int ticks, double weight = 1.0, std::uint64_t seed = 1) {
  auto controller = IntermittentController::create(options, kTick, seed).value();
  std::vector<Vector2d> forces;
  for (int i = 0; i < ticks; ++i) forces.push_back(controller.step(hand, force, kStiffness, weight));
  return forces;
}

/// The first tick with a force, 0 for none.
std::size_t first_force(const std::vector<Vector2d>& forces) {
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (forces[i].norm() > 0.0) return i;
  }
  return 0;
}

TEST(IntermittentController, FirstStepIsTheGainTimesStiffnessTimesDisplacementOnASmoothRamp) {
  IntermittentController::Options options = exact_options();
  options.leak = 1e9;
  const Vector2d displacement(0.003, 0.002);
  const auto forces = held(options, kTarget + displacement, {0, 0}, 1000, 0.7);
  const Vector2d expected = -0.7 * 1.4 * kStiffness * displacement;
  const std::size_t start = first_force(forces);
  for (const double s : {0.25, 0.5, 1.0}) {
    const Vector2d now = forces[start + static_cast<std::size_t>(std::lround(220.0 * s)) - 1];
    EXPECT_LT((now - s * s * s * (10.0 - 15.0 * s + 6.0 * s * s) * expected).norm(), 1e-9) << s;
  }
  EXPECT_LT((forces[start + 279] - expected).norm(), 1e-9);
  EXPECT_GT((forces[start + 300] - expected).norm(), 0.0);  // the next decision, 0.28 s after the first
}

TEST(IntermittentController, LooksAtTheStiffnessOnlyWhereItIsToDecide) {
  const std::size_t ticks = 2000;
  const Vector2d hand = kTarget + Vector2d(0.003, 0.002);
  const auto always = held(exact_options(), hand, {0, 0}, ticks);
  auto controller = IntermittentController::create(exact_options(), kTick, 1).value();
  int decisions = 0;
  for (std::size_t i = 0; i < ticks; ++i) {
    const bool decides = controller.is_to_decide();
    const Matrix2d K = decides ? kStiffness : Matrix2d::Constant(std::nan(""));
    EXPECT_EQ(controller.step(hand, {0, 0}, K, 1.0), always[i]) << i;
    decisions += decides ? 1 : 0;
  }
  EXPECT_NEAR(decisions, ticks * kTick / exact_options().interval, 1.0);
}

TEST(IntermittentController, AnswersAfterTheDelayAndWithinOneInterval) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const std::size_t start =
        first_force(held(exact_options(), kTarget + Vector2d(0.003, 0.0), {0, 0}, 1000, 1.0, seed));
    EXPECT_GE(start, 150u) << "seed " << seed;
    EXPECT_LT(start, 150u + 280u) << "seed " << seed;
  }
}

TEST(IntermittentController, DoesNothingBelowItsThresholds) {
  IntermittentController::Options options = exact_options();
  options.force_gain = 0.5;
  for (const Vector2d& force : held(options, kTarget + Vector2d(0.0, 0.00149), {0.19, 0.0}, 2000)) {
    EXPECT_EQ(force, Vector2d(0.0, 0.0));
  }
}

TEST(IntermittentController, StepIsLimitedInItsDirection) {
  IntermittentController::Options options = exact_options();
  options.leak = 1e9;
  const Vector2d displacement(0.03, -0.02);
  const auto forces = held(options, kTarget + displacement, {0, 0}, 1000);
  const Vector2d step = forces[first_force(forces) + 279];
  EXPECT_NEAR(step.norm(), 2.5, 1e-9);
  EXPECT_LT((step.normalized() + (kStiffness * displacement).normalized()).norm(), 1e-9);
}

TEST(IntermittentController, ForceLeaksAway) {
  IntermittentController::Options options = exact_options();
  auto controller = IntermittentController::create(options, kTick, 1).value();
  for (int i = 0; i < 1000; ++i) controller.step(kTarget + Vector2d(0.003, 0.0), {0, 0}, kStiffness, 1.0);
  for (int i = 0; i < 500; ++i) controller.step(kTarget, {0, 0}, kStiffness, 1.0);
  const Vector2d before = controller.force();
  for (int i = 0; i < 8000; ++i) controller.step(kTarget, {0, 0}, kStiffness, 1.0);
  EXPECT_LT((controller.force() - std::exp(-1.0) * before).norm(), 1e-9 * before.norm());
}

TEST(IntermittentController, HoldsAForceAgainstAWallWithForceGainAlone) {
  IntermittentController::Options options;
  options.force_gain = 0.5;
  options.force = {0.0, 3.0};
  options.force_threshold = 0.0;
  auto controller = IntermittentController::create(options, kTick, 1).value();
  Vector2d force = {0.0, 0.0};  // a wall answers with what it gets
  for (int i = 0; i < 20000; ++i) force = controller.step(kTarget + Vector2d(0.1, 0.0), force, kStiffness, 1.0);
  EXPECT_LT((force - options.force).norm(), 0.25);  // leak 0.28/8 against gain 0.5 leaves 7 % of 3 N, and 20 % errors
}

TEST(IntermittentController, RandomErrorHasTheAskedSizeInEveryDirection) {
  IntermittentController::Options options = exact_options();
  options.random_error = 0.2;
  options.leak = 1e9;
  const Vector2d displacement(0.003, 0.002);
  const Vector2d exact = -1.4 * kStiffness * displacement;
  double along = 0.0, across = 0.0;
  const int seeds = 1000;  // 4.5 % error of a variance
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto forces = held(options, kTarget + displacement, {0, 0}, 700, 1.0, static_cast<std::uint64_t>(seed));
    const Vector2d error = (forces[first_force(forces) + 220] - exact) / exact.norm();
    const Vector2d u = exact.normalized();
    along += std::pow(error.dot(u), 2) / seeds;
    across += std::pow(error.dot(Vector2d(-u.y(), u.x())), 2) / seeds;
  }
  EXPECT_NEAR(along, 0.04, 0.2 * 0.04);
  EXPECT_NEAR(across, 0.04, 0.2 * 0.04);
}

TEST(IntermittentController, ZeroGainsMeanNoWill) {
  for (const Vector2d& force : held({}, kTarget + Vector2d(0.1, 0.1), {5.0, 5.0}, 2000)) {
    EXPECT_EQ(force, Vector2d(0.0, 0.0));
  }
}

TEST(IntermittentController, RefusesARampLongerThanItsInterval) {
  IntermittentController::Options options;
  options.ramp = 0.3;
  const std::string refused = IntermittentController::create(options, kTick, 1).error().message;
  for (const char* const time : {"0.3 s", "0.28 s"}) EXPECT_NE(refused.find(time), std::string::npos) << refused;
  options = {};
  options.delay = -0.1;
  EXPECT_FALSE(IntermittentController::create(options, kTick, 1));
  EXPECT_FALSE(IntermittentController::create({}, 0.0, 1));
}

}  // namespace intermittent_controller_test
}  // namespace mbk::participant
