#include "mbk/experiment/control/passivity_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "mbk/base/core/nan.h"
#include "tests/support/allocations.h"

namespace mbk::control {
namespace passivity_control_test {

constexpr double kTick = 1e-3;
constexpr double kRounding = 1e-12;  // [J], of sums of thousands of terms far below 1 J

/// A device that a hand pushes against a virtual wall, moved on exactly over each tick.
struct Wall {
  double stiffness = 30e3;  // [N/m]
  double mass = 0.8, damping = 0.2, push = 2.0, start = -0.02;

  struct Run {
    double energy = 0.0, lowest = 0.0, largest_step = 0.0;  // [J]
    bool altered = false;
  };

  [[nodiscard]] Run run(double duration, std::optional<SeriesPassivityController> controller) const {
    PassivityObserver observer;
    Run run;
    double x = start, v = 0.0, before = start;
    const auto ticks = static_cast<int>(std::lround(duration / kTick));
    for (int n = 0; n <= ticks; ++n) {
      const double asked = x > 0.0 ? stiffness * x : 0.0;
      const double force = controller ? controller->step(x, asked) : asked;
      observer.step(x, force);
      run.altered = run.altered || force != asked;
      run.lowest = std::min(run.lowest, observer.energy());
      run.largest_step = std::max(run.largest_step, std::abs(asked * (x - before)));
      before = x;
      const double slowest = (push - force) / damping, left = std::exp(-damping * kTick / mass);
      x += slowest * kTick + (v - slowest) * mass / damping * (1.0 - left);
      v = slowest + (v - slowest) * left;
    }
    run.energy = observer.energy();
    return run;
  }

  [[nodiscard]] Run observed(double duration) const { return run(duration, {}); }
  [[nodiscard]] Run controlled(double duration) const {
    return run(duration, SeriesPassivityController::create(kTick, 0.5 * mass / kTick).value());
  }
};

TEST(SeriesPassivityController, TakesAWallOf30kNPerMetreFromMinus237ToMinus7Millijoules) {
  const Wall wall;
  constexpr double kLastDigit = 0.0005;  // of the figures as they are known [J]
  EXPECT_NEAR(wall.observed(3.0).energy, -0.237, kLastDigit);
  EXPECT_NEAR(wall.controlled(3.0).lowest, -0.007, kLastDigit);
}

TEST(SeriesPassivityController, KeepsTheEnergyAboveMinusThatOfOneStep) {
  for (const double stiffness : {3e3, 10e3, 30e3, 60e3}) {
    const Wall wall{.stiffness = stiffness, .push = 3.0};
    const Wall::Run run = wall.controlled(2.0);
    EXPECT_LT(wall.observed(2.0).lowest, run.lowest);
    EXPECT_GT(run.lowest, -run.largest_step) << stiffness;
  }
}

TEST(SeriesPassivityController, NeverAltersAPassiveOnePort) {
  // a spring and a damper whose force is the mean over the motion to come, so that E is what they store and lose
  auto controller = SeriesPassivityController::create(kTick, 100.0).value();
  for (int n = 0; n < 5000; ++n) {
    const double t = kTick * n, x = 0.01 * std::sin(7.0 * t) * std::sin(1.3 * t);
    const double next = 0.01 * std::sin(7.0 * (t + kTick)) * std::sin(1.3 * (t + kTick));
    const double force = 200.0 * 0.5 * (x + next) + 3.0 * (next - x) / kTick;
    EXPECT_EQ(controller.step(x, force), force);
    ASSERT_GE(controller.energy(), 0.0);
  }
}

TEST(SeriesPassivityController, TakesBackWhatIsMissingInOneStepOfEvenMotion) {
  auto controller = SeriesPassivityController::create(kTick, 1e6).value();
  PassivityObserver observer;
  double x = 0.0;
  for (int n = 0; n < 50; ++n, x += 1e-4) {
    const double force = controller.step(x, -2.0);  // pushes along: gives 0.2 mJ each step
    observer.step(x, force);
    EXPECT_NEAR(controller.energy(), observer.energy(), kRounding);
    EXPECT_GE(controller.energy(), -2.0 * 1e-4 - kRounding);
  }
}

TEST(SeriesPassivityController, StaysWithinItsLargestDamping) {
  auto controller = SeriesPassivityController::create(kTick, 5.0).value();
  double x = 0.0;
  for (int n = 0; n < 100; ++n, x += 1e-6) {
    const double force = controller.step(x, -2.0);
    EXPECT_LE(force + 2.0, 5.0 * 1e-6 / kTick + kRounding);
  }
}

TEST(PassivityObserver, IsTheSumOfForceTimesTheMotionThatFollowsIt) {
  PassivityObserver observer;
  const std::vector<double> x = {0.0, 0.1, 0.3, 0.2}, f = {1.0, -2.0, 4.0, 7.0};
  for (std::size_t n = 0; n < x.size(); ++n) observer.step(x[n], f[n]);
  EXPECT_NEAR(observer.energy(), 1.0 * 0.1 - 2.0 * 0.2 - 4.0 * 0.1, kRounding);
}

TEST(PassivityObserver, LeavesOutWhatIsNotFinite) {
  PassivityObserver observer;
  observer.step(0.0, 1.0);
  observer.step(0.1, 1.0);
  observer.step(kNaN, 1.0);
  observer.step(0.5, 2.0);  // begins anew: the motion from 0.1 is not known to have met that force
  observer.step(0.6, 2.0);
  EXPECT_NEAR(observer.energy(), 0.1 + 0.2, kRounding);
}

TEST(ParallelPassivityController, NeverLetsTheEnergyFallBelowZero) {
  auto controller = ParallelPassivityController::create(kTick, 1e6).value();
  double energy = 0.0;
  for (int n = 0; n < 5000; ++n) {
    const double force = std::sin(0.03 * n) + 0.4 * std::cos(0.011 * n), expected = -0.01 * force + 0.005;
    const double velocity = controller.step(force, expected);
    energy += kTick * force * velocity;
    ASSERT_GE(energy, -kRounding);
    EXPECT_NEAR(controller.energy(), energy, kRounding);
  }
}

TEST(ParallelPassivityController, NeverAltersAPassiveOnePort) {
  auto controller = ParallelPassivityController::create(kTick, 1.0).value();
  for (int n = 0; n < 5000; ++n) {
    const double force = std::sin(0.03 * n), velocity = 0.02 * force;
    EXPECT_EQ(controller.step(force, velocity), velocity);
  }
}

TEST(ParallelPassivityController, StaysWithinItsLargestAdmittance) {
  auto controller = ParallelPassivityController::create(kTick, 0.5).value();
  for (int n = 0; n < 100; ++n) EXPECT_LE(controller.step(0.1, -1.0), -1.0 + 0.5 * 0.1);
}

TEST(PassivityControllers, RefuseLimitsThatAreNotAboveZero) {
  for (const double wrong : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(SeriesPassivityController::create(wrong, 1.0));
    EXPECT_FALSE(SeriesPassivityController::create(kTick, wrong));
    EXPECT_FALSE(ParallelPassivityController::create(wrong, 1.0));
    EXPECT_FALSE(ParallelPassivityController::create(kTick, wrong));
  }
}

TEST(PassivityControllers, GiveOnWhatIsNotFiniteAndGoOn) {
  auto series = SeriesPassivityController::create(kTick, 1.0).value();
  auto parallel = ParallelPassivityController::create(kTick, 1.0).value();
  EXPECT_EQ(series.step(kNaN, 3.0), 3.0);
  EXPECT_TRUE(std::isnan(series.step(0.0, kNaN)));
  EXPECT_EQ(parallel.step(kNaN, 3.0), 3.0);
  EXPECT_EQ(series.energy(), 0.0);
  EXPECT_EQ(parallel.energy(), 0.0);
}

TEST(PassivityControllers, DoNotAllocate) {
  auto series = SeriesPassivityController::create(kTick, 1.0).value();
  auto parallel = ParallelPassivityController::create(kTick, 1.0).value();
  const long before = testing_support::allocations();
  double x = 0.0;
  for (int n = 0; n < 1000; ++n) {
    x += 1e-3 * series.step(x, -1.0);
    x += 1e-3 * parallel.step(x, -1.0);
  }
  EXPECT_EQ(testing_support::allocations(), before);
  const std::vector<double> seen(3, x);
  EXPECT_GT(testing_support::allocations(), before) << "this counter does not count " << seen.front();
}

}  // namespace passivity_control_test
}  // namespace mbk::control
