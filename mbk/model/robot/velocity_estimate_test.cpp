#include "mbk/model/robot/velocity_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/model/robot/kinematics.h"

namespace mbk::robot {
namespace velocity_estimate_test {

constexpr double kTick = 1e-3;

TEST(VelocityEstimate, IsTheSlopeOfALineOnceItHasSettled) {
  VelocityEstimate velocity = VelocityEstimate::create(kTick, Hertz(50.0)).value();
  const Vector2d rate(0.3, -2.0);
  JointVector estimate;
  for (int i = 0; i < 200; ++i) estimate = velocity.step(Vector2d(1.0, 2.0) + i * kTick * rate);
  EXPECT_LT((estimate - rate).norm(), 1e-9);  // e^{−2π 50 0.2}, and rounding of 2 rad over 1 ms
}

TEST(VelocityEstimate, BeginsAtRestWhereverTheJointsAreAndHoweverManyThereAre) {
  for (const Index joints : {1, 2, 3, kMaxJoints}) {
    VelocityEstimate velocity = VelocityEstimate::create(kTick, Hertz(50.0)).value();
    EXPECT_EQ(velocity.step(JointVector::Constant(joints, 7.0)), JointVector::Zero(joints));
  }
}

TEST(VelocityEstimate, PassesHalfThePowerAtItsCutoff) {
  VelocityEstimate velocity = VelocityEstimate::create(kTick, Hertz(20.0)).value();
  const double omega = 2.0 * std::numbers::pi * 20.0;
  double largest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double value = velocity.step(Vector2d(std::sin(omega * i * kTick) / omega, 0.0))[0];
    if (i > 1000) largest = std::max(largest, std::abs(value));
  }
  EXPECT_NEAR(largest, std::sqrt(0.5), 0.01);  // the discrete filter's, 20 Hz against 1 kHz
}

TEST(VelocityEstimate, RefusesTimesAndCutoffsThatAreNone) {
  EXPECT_FALSE(VelocityEstimate::create(kTick, Hertz(0.0)));
  EXPECT_FALSE(VelocityEstimate::create(0.0, Hertz(50.0)));
}

}  // namespace velocity_estimate_test
}  // namespace mbk::robot
