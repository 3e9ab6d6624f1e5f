#include "mbk/simulate/participant/tone_robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace mbk::participant {
namespace tone_robot_test {

constexpr double kTick = 1e-3;
const Vector2d kHome(0.30, -0.05);

ToneRobot::Options quiet() {
  ToneRobot::Options options;
  options.stiffness.setZero();
  options.damping.setZero();
  options.motor_lag = 0.0;
  return options;
}

/// What the device resists with after the hand has been in a state for some ticks.
Vector2d resistance(ToneRobot& device, const HandState<2>& hand, int ticks = 50) {
  for (int i = 0; i < ticks; ++i) device.tick(i * kTick, kTick, hand, {0.0, 0.0});
  return device.dynamics(hand).bias;
}

TEST(ToneRobot, HasItsProgrammedStiffnessAndDamping) {
  ToneRobot device = ToneRobot::create({}).value();
  const HandState<2> hand = {kHome + Vector2d(0.02, -0.01), {0.04, 0.03}};
  const impedance::Model model = device.impedance(kHome);
  const Vector2d expected = model.B * hand.velocity + model.K * (hand.position - kHome);
  EXPECT_LT((resistance(device, hand) - expected).norm(), 1e-9);  // e^(−50/2) of the lag is left
  EXPECT_EQ(device.dynamics(hand).inertia, model.M);
}

TEST(ToneRobot, ForceComesOneTickLateAndBehindItsLag) {
  ToneRobot::Options options = quiet();
  options.stiffness.setIdentity();
  options.stiffness *= 100.0;
  options.motor_lag = 0.005;
  ToneRobot device = ToneRobot::create(options).value();
  const HandState<2> hand = {kHome + Vector2d(0.05, 0.0)};
  for (int tick = 0; tick < 20; ++tick) {
    device.tick(tick * kTick, kTick, hand, {0.0, 0.0});
    EXPECT_NEAR(device.dynamics(hand).bias.x(), 5.0 * (1.0 - std::exp(-tick * kTick / 0.005)), 1e-12) << tick;
  }
}

TEST(ToneRobot, RigidityResistsEquallyAtEverySpeedInEveryDirection) {
  ToneRobot::Options options = quiet();
  options.rigidity = 4.0;
  ToneRobot device = ToneRobot::create(options).value();
  for (const double speed : {0.1, 0.5}) {
    for (const double angle : {0.3, 2.0, 4.0}) {
      const Vector2d direction(std::cos(angle), std::sin(angle));
      const Vector2d force = resistance(device, {kHome, speed * direction});
      EXPECT_LT((force - 4.0 * direction).norm(), 4.0 * 0.5 * std::pow(0.005 / speed, 2) + 1e-12);
    }
  }
  EXPECT_EQ(resistance(device, {kHome + Vector2d(0.05, 0.0)}), Vector2d(0.0, 0.0));
}

TEST(ToneRobot, CatchAnswersFastStretchInItsDirectionOnly) {
  ToneRobot::Options options = quiet();
  options.catch_gain = 60.0;
  ToneRobot device = ToneRobot::create(options).value();
  EXPECT_LT((resistance(device, {kHome, {0.15, 0.2}}) - Vector2d(6.0, 0.0)).norm(), 1e-12);
  EXPECT_EQ(resistance(device, {kHome, {0.04, 0.0}}), Vector2d(0.0, 0.0));
  EXPECT_EQ(resistance(device, {kHome, {-0.3, 0.0}}), Vector2d(0.0, 0.0));
  EXPECT_EQ(resistance(device, {kHome, {0.0, 0.3}}), Vector2d(0.0, 0.0));
}

TEST(ToneRobot, ClaspKnifeLetsGoUntilTheStretchIsOver) {
  ToneRobot::Options options = quiet();
  options.catch_gain = 60.0;
  options.release_force = 8.0;
  ToneRobot device = ToneRobot::create(options).value();
  EXPECT_NEAR(resistance(device, {kHome, {0.15, 0.0}}).x(), 6.0, 1e-12);
  EXPECT_EQ(resistance(device, {kHome, {0.25, 0.0}}).x(), 0.0);
  EXPECT_TRUE(device.released());
  EXPECT_EQ(resistance(device, {kHome, {0.15, 0.0}}).x(), 0.0);
  EXPECT_EQ(resistance(device, {kHome, {-0.1, 0.0}}).x(), 0.0);
  EXPECT_FALSE(device.released());
  EXPECT_NEAR(resistance(device, {kHome, {0.15, 0.0}}).x(), 6.0, 1e-12);
}

TEST(ToneRobot, NeverPushesHarderThanItsMotors) {
  ToneRobot::Options options;
  options.largest_force = 10.0;
  ToneRobot device = ToneRobot::create(options).value();
  EXPECT_NEAR(resistance(device, {kHome + Vector2d(0.5, 0.5)}).norm(), 10.0, 1e-8);
}

TEST(ToneRobot, RefusesWhatIsNoDevice) {
  ToneRobot::Options options;
  options.release_force = 0.0;
  EXPECT_NE(ToneRobot::create(options).error().message.find(" 0 N"), std::string::npos);
  options = {};
  options.largest_force = -1.0;
  EXPECT_FALSE(ToneRobot::create(options));
  options = {};
  options.damping(0, 0) = NAN;
  EXPECT_FALSE(ToneRobot::create(options));
}

}  // namespace tone_robot_test
}  // namespace mbk::participant
