#include "mbk/experiment/safety/motion_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mbk::safety {
namespace {

/// x(t) = x₀ + v t + ½ a t² + b t³ along x, with a(t) at the accelerometer.
MotionSample sample(double t) {
  MotionSample s;
  s.time = t;
  s.hand = {0.3 + 0.2 * t + 0.5 * 1.5 * t * t + 0.4 * t * t * t, -0.1};
  s.joint = {0.1 * t * t, 1.0};
  s.acceleration = {1.5 + 6.0 * 0.4 * t, 0.0};
  s.force = {2.0, 3.0 * t};
  s.torque = {0.5, t};
  return s;
}

TEST(MotionWindow, ShowsTheAccelerationOfAPolynomialExactlyOnEvenStamps) {
  MotionWindow window;
  for (int k = 0; k < MotionWindow::kSize; ++k) {
    EXPECT_FALSE(window.full());
    window.add(sample(1e-3 * k));
  }
  ASSERT_TRUE(window.full());
  const auto means = window.means();
  const double middle = 20e-3;  // of a cubic the mean under the triangle is the value at its tip
  EXPECT_NEAR(means.hand_acceleration[0], sample(middle).acceleration[0], 1e-9);
  EXPECT_NEAR(means.acceleration[0], sample(middle).acceleration[0], 1e-12);
  EXPECT_NEAR(means.joint_acceleration[0], 0.2, 1e-9);
  EXPECT_NEAR(means.force[1], 3.0 * middle, 1e-12);
  EXPECT_NEAR(means.torque[1], middle, 1e-12);
  EXPECT_NEAR(window.speed(), (sample(40e-3).hand - sample(20e-3).hand).norm() / 20e-3, 1e-12);
}

/// What was lost or came late is no motion: both accelerations still agree, by the robot's stamps.
TEST(MotionWindow, LostAndJitteringStatesAreNoAcceleration) {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> steps(1, 4);
  MotionWindow window;
  int at = 0;
  double by_tick = 0.0, by_stamp = 0.0;
  for (int k = 0; k < 400; ++k) {
    at += steps(random);
    window.add(sample(1e-3 * at));
    if (!window.full()) continue;
    const auto means = window.means();
    by_stamp = std::max(by_stamp, std::abs(means.hand_acceleration[0] - means.acceleration[0]));
    const double even = (window.before(0).hand - 2.0 * window.before(20).hand + window.before(40).hand)[0] / 4e-4;
    by_tick = std::max(by_tick, std::abs(even - means.acceleration[0]));
  }
  EXPECT_LT(by_stamp, 2e-2);  // the trapezoidal rule on an acceleration that changes by 2.4 m/s³
  EXPECT_GT(by_tick, 1.0);    // counted in ticks the same states seem to be shaken
}

TEST(MotionWindow, ForgetsWhatWasBefore) {
  MotionWindow window;
  for (int k = 0; k < 50; ++k) window.add(sample(1e-3 * k));
  window.forget();
  EXPECT_FALSE(window.half());
  window.add(sample(1.0));
  EXPECT_FALSE(window.half());
}

}  // namespace
}  // namespace mbk::safety
