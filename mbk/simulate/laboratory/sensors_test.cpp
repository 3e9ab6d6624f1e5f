#include "mbk/simulate/laboratory/sensors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "mbk/simulate/laboratory/link_axes.h"
#include "tests/support/allocations.h"

namespace mbk::laboratory {
namespace sensors_test {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kTick = 1e-3;
const robot::Geometry kGeometry;

SensorSuite<2> suite(const SensorOptions<2>& options, std::uint64_t seed = 1) {
  return SensorSuite<2>::create(options, kGeometry, kTick, seed).value();
}

/// Every part switched off, one by one.
SensorOptions<2> silent() {
  SensorOptions<2> options;
  options.encoder_resolution = 0.0;
  options.force = LoadCellOptions<2>{.white_noise = 0.0};
  options.acceleration = AccelerometerOptions<2>{.noise = 0.0};
  options.torque = MotorCurrentOptions<2>{};
  return options;
}

/// Some state of a rigid drive in motion.
TrueState<2> state(int k) {
  const double t = k * kTick;
  TrueState<2> s;
  s.time = t;
  s.theta = {0.2 + 0.3 * std::sin(3.0 * t), 1.1 + 0.4 * std::sin(4.0 * t)};
  s.motor_angle = s.theta;
  s.position = robot::hand_position(kGeometry, s.theta);
  s.acceleration = {3.0 * std::sin(7.0 * t), -2.0 * std::cos(5.0 * t)};
  s.force_hand_on_robot = {9.0 * std::cos(6.0 * t), 4.0 + 5.0 * std::sin(2.0 * t)};
  s.motor_torque = {2.0 * std::sin(9.0 * t), 1.0};
  return s;
}

template <int Axes>
void expect_truth(const typename SensorSuite<Axes>::Reading& reading, const TrueState<Axes>& truth) {
  EXPECT_EQ(reading.time, truth.time);
  EXPECT_EQ(reading.joint, truth.theta);
  EXPECT_EQ(reading.hand, truth.position);
  EXPECT_EQ(reading.force, truth.force_hand_on_robot);
  EXPECT_EQ(reading.acceleration, truth.acceleration);
  EXPECT_EQ(reading.torque, truth.motor_torque);
}

TEST(SensorSuite, PerfectOrSilentReadsTheTruthToTheLastBit) {
  for (const SensorOptions<2>& options : {SensorOptions<2>::perfect(), silent()}) {
    SensorSuite<2> sensors = suite(options);
    for (int k = 0; k < 500; ++k) expect_truth(sensors.read(state(k)), state(k));
    EXPECT_EQ(sensors.next_interval(), kTick);
    EXPECT_EQ(sensors.clipped_samples(), 0);
    EXPECT_EQ(sensors.force_delay(), 0.0);
  }
}

TEST(SensorSuite, EncodersCountInStepsOfTwoMicrometresAtTheFirstLink) {
  const double count = SensorOptions<2>{}.encoder_resolution;
  EXPECT_NEAR(count * kGeometry.d1, 2e-6, 1e-20);
  SensorSuite<2> sensors = suite({});
  double square = 0.0;
  constexpr int kCount = 20000;
  for (int k = 0; k < kCount; ++k) {
    const Vector2d angle = state(k).motor_angle, error = sensors.encoders(angle) - angle;
    ASSERT_LE(error.cwiseAbs().maxCoeff(), 0.5 * count * (1.0 + 1e-9)) << k;
    square += error.squaredNorm() / (2.0 * kCount);
  }
  EXPECT_NEAR(std::sqrt(square), count / std::sqrt(12.0), 0.02 * count / std::sqrt(12.0));
}

TEST(SensorSuite, HandIsTheForwardKinematicsOfWhatTheControllerSees) {
  SensorSuite<2> sensors = suite({});
  TrueState<2> truth = state(100);
  truth.motor_angle += Vector2d(0.003, -0.002);  // elastic cables
  const SensorSuite<2>::Reading reading = sensors.read(truth);
  EXPECT_EQ(reading.joint, sensors.encoders(truth.motor_angle));
  EXPECT_EQ(reading.hand, robot::hand_position(kGeometry, reading.joint));
}

TEST(LinkAxes, AreThePhysicalRotationOfTheLastLink) {
  for (double theta2 = -0.5; theta2 < 3.0; theta2 += 0.1) {
    const Matrix2d axes = link_axes(theta2);
    EXPECT_LT((axes.transpose() * axes - Matrix2d::Identity()).norm(), 1e-15);
    EXPECT_NEAR(axes.determinant(), 1.0, 1e-15);
    // The last link stands at θ₂ − 90° from the x axis; its x_s points from the elbow to the hand
    EXPECT_LT((axes - Eigen::Rotation2Dd(theta2 - kPi / 2.0).toRotationMatrix()).norm(), 1e-15);
    const Vector2d theta(0.3, theta2);
    const Vector2d link = robot::hand_position(kGeometry, theta) - robot::elbow_position(kGeometry, theta);
    EXPECT_LT((kGeometry.d2 * axes.col(0) - link).norm(), 1e-15);
  }
}

TEST(SensorSuite, ForceErrorsTurnWithTheLastLink) {
  SensorOptions<2> options = silent();
  options.force = LoadCellOptions<2>{.white_noise = 0.0, .offset = {1.0, 0.0}};
  SensorSuite<2> sensors = suite(options);
  for (const int k : {0, 300, 700}) {
    const Vector2d error = sensors.read(state(k)).force - state(k).force_hand_on_robot;
    const double theta2 = state(k).theta[1];
    EXPECT_LT((error - Vector2d(std::sin(theta2), -std::cos(theta2))).norm(), 1e-14) << k;
  }
}

TEST(SensorSuite, WrongAngleTurnsForceAndAcceleration) {
  SensorSuite<2> sensors = suite(silent());
  TrueState<2> truth = state(100);
  truth.motor_angle[1] += 0.01;  // what the cable hides from the encoder
  const SensorSuite<2>::Reading reading = sensors.read(truth);
  const Matrix2d turn = Eigen::Rotation2Dd(0.01).toRotationMatrix();
  EXPECT_LT((reading.force - turn * truth.force_hand_on_robot).norm(), 1e-13);
  EXPECT_LT((reading.acceleration - turn * truth.acceleration).norm(), 1e-13);
}

TEST(SensorSuite, AccelerometerIsTurnedToTheBaseFrame) {
  SensorOptions<2> options = silent();
  options.acceleration = AccelerometerOptions<2>{.noise = 0.0, .gain_error = {0.1, 0.0}};
  SensorSuite<2> sensors = suite(options);
  const TrueState<2> truth = state(100);
  const Matrix2d axes = link_axes(truth.theta[1]);
  const Vector2d expected = axes * Vector2d(1.1, 1.0).asDiagonal() * axes.transpose() * truth.acceleration;
  EXPECT_LT((sensors.read(truth).acceleration - expected).norm(), 1e-14);
}

TEST(SensorSuite, StrainGaugeWithoutItsFilterReadsWithinHalfAStepOfEachAxis) {
  SensorOptions<2> options = silent();
  options.force = StrainGaugeOptions{.bridge_noise = 0.0, .cutoff = Hertz(0.0)};
  SensorSuite<2> sensors = suite(options);
  const double half_steps = 0.5 * std::hypot(8.56, 8.15) * 20.0 / 4096.0;
  for (int k = 0; k < 1000; ++k) {
    const TrueState<2> truth = state(k);
    ASSERT_LE((sensors.read(truth).force - truth.force_hand_on_robot).norm(), half_steps * (1.0 + 1e-9)) << k;
  }
}

TEST(SensorSuite, PassesOnDelayAndClippedSamplesOfTheStrainGauge) {
  SensorOptions<2> options;
  options.force = StrainGaugeOptions{};
  SensorSuite<2> sensors = suite(options);
  EXPECT_NEAR(sensors.force_delay(), 8.56e-3, 5e-6);
  TrueState<2> truth = state(0);
  truth.force_hand_on_robot = {300.0, 0.0};
  for (int k = 0; k < 3; ++k) (void)sensors.read(truth);
  EXPECT_EQ(sensors.clipped_samples(), 3);
}

TEST(SensorSuite, TorqueFromTheCurrentHasTheErrorOfItsConstantAndNoise) {
  SensorOptions<2> options = silent();
  options.torque =
      MotorCurrentOptions<2>{.torque_constant = {0.5, 0.25}, .torque_constant_error = {0.1, -0.2}, .noise = 0.04};
  SensorSuite<2> sensors = suite(options);
  TrueState<2> truth = state(0);
  truth.motor_torque = {2.0, -1.0};
  constexpr int kCount = 100000;
  Vector2d mean = Vector2d::Zero(), square = Vector2d::Zero();
  for (int k = 0; k < kCount; ++k) {
    const Vector2d torque = sensors.read(truth).torque;
    mean += torque / kCount;
    square += (torque - Vector2d(2.2, -0.8)).cwiseAbs2() / kCount;
  }
  const Vector2d deviation(0.5 * 1.1 * 0.04, 0.25 * 0.8 * 0.04);
  EXPECT_LT((mean - Vector2d(2.2, -0.8)).norm(), 5.0 * deviation.norm() / std::sqrt(kCount));
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(std::sqrt(square[i]), deviation[i], 0.012 * deviation[i]);  // 5 errors
}

TEST(SensorSuite, TimestampsAreWhenTheTickWasOrWhenItShouldHaveBeen) {
  SensorOptions<2> actual, nominal;
  actual.clock.jitter = nominal.clock.jitter = 5e-5;
  nominal.clock.timestamps = ClockOptions::Timestamps::nominal;
  SensorSuite<2> first = suite(actual), second = suite(nominal);
  double time = kTick;
  for (int k = 0; k < 1000; ++k) {
    TrueState<2> truth = state(0);
    truth.time = time;
    ASSERT_EQ(first.read(truth).time, time);
    ASSERT_NEAR(second.read(truth).time, (k + 1) * kTick, 1e-15 * (k + 1));
    const double interval = first.next_interval();
    ASSERT_EQ(interval, second.next_interval());
    time += interval;
  }
}

/// What two suites with the same seed read in some ticks, one column each.
using Signals = std::vector<std::pair<std::string, std::vector<double>>>;
Signals record(const SensorOptions<2>& options) {
  SensorSuite<2> sensors = suite(options, 11);
  Signals signals = {{"clock", {}}, {"force", {}}, {"acceleration", {}}, {"torque", {}}, {"hand", {}}};
  for (int k = 0; k < 50; ++k) {
    signals[0].second.push_back(sensors.next_interval());
    const SensorSuite<2>::Reading reading = sensors.read(state(k));
    signals[1].second.push_back(reading.force[0]);
    signals[2].second.push_back(reading.acceleration[0]);
    signals[3].second.push_back(reading.torque[0]);
    signals[4].second.push_back(reading.hand[0]);
  }
  return signals;
}

TEST(SensorSuite, OneNoiseLeavesEveryOtherSignalAsItWas) {
  SensorOptions<2> loud;
  loud.clock.jitter = 1e-5;
  loud.torque = MotorCurrentOptions<2>{.noise = 0.01};
  const Signals all = record(loud);
  const auto same_but = [&](const std::string& changed, const SensorOptions<2>& options) {
    const Signals other = record(options);
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(all[i].second != other[i].second, all[i].first == changed) << all[i].first << " without " << changed;
    }
  };
  SensorOptions<2> options = loud;
  options.clock.jitter = 0.0;
  same_but("clock", options);
  options = loud;
  options.force = PerfectSensor{};
  same_but("force", options);
  options = loud;
  options.acceleration = PerfectSensor{};
  same_but("acceleration", options);
  options = loud;
  options.torque = CommandedTorque{};
  same_but("torque", options);
}

TEST(SensorSuite, SameSeedReadsTheSameAndAnotherSeedOtherwise) {
  SensorSuite<2> first = suite({}, 4), again = suite({}, 4), other = suite({}, 5);
  const Vector2d force = first.read(state(3)).force;
  EXPECT_EQ(force, again.read(state(3)).force);
  EXPECT_NE(force, other.read(state(3)).force);
}

TEST(SensorSuite, ReadsWithoutAllocating) {
  SensorOptions<2> strain_gauge;
  strain_gauge.force = StrainGaugeOptions{};
  strain_gauge.acceleration = AccelerometerOptions<2>{.bandwidth = Hertz(100.0)};
  strain_gauge.torque = MotorCurrentOptions<2>{.noise = 0.01};
  strain_gauge.clock.jitter = 1e-5;
  for (const SensorOptions<2>& options : {SensorOptions<2>{}, strain_gauge}) {
    const long before_making = testing_support::allocations();
    SensorSuite<2> sensors = suite(options);
    EXPECT_GT(testing_support::allocations(), before_making);  // the counter counts
    const long before = testing_support::allocations();
    double sum = 0.0;
    for (int k = 0; k < 1000; ++k) {
      sum +=
          sensors.next_interval() + sensors.encoders(state(k).motor_angle).sum() + sensors.read(state(k)).force.sum();
    }
    EXPECT_EQ(testing_support::allocations(), before);
    EXPECT_TRUE(std::isfinite(sum));
  }
}

TEST(SensorSuite, RefusesWhatHasNoMeaning) {
  const auto message = [](auto change, double sample_time = kTick) {
    SensorOptions<2> options;
    change(options);
    const auto sensors = SensorSuite<2>::create(options, kGeometry, sample_time, 1);
    return sensors ? std::string() : sensors.error().message;
  };
  EXPECT_EQ(message([](auto&) {}), "");
  EXPECT_THAT(message([](auto&) {}, 0.0), AllOf(HasSubstr("sample time"), HasSubstr(" 0 s")));
  EXPECT_THAT(message([](auto& o) { o.encoder_resolution = -1e-6; }),
              AllOf(HasSubstr("encoder"), HasSubstr("-1e-06 rad")));
  EXPECT_THAT(message([](auto& o) { o.clock.jitter = 5e-4; }),
              AllOf(HasSubstr("jitter"), HasSubstr("0.0005 s"), HasSubstr("0.001 s")));
  EXPECT_THAT(message([](auto& o) {
                o.torque = MotorCurrentOptions<2>{.torque_constant = {0.1, 0.0}};
              }),
              HasSubstr(" 0 N·m/A"));
  EXPECT_NE(message([](auto& o) { o.torque = MotorCurrentOptions<2>{.noise = -1.0}; }), "");
  EXPECT_NE(message([](auto& o) { o.force = LoadCellOptions<2>{.white_noise = -1.0}; }), "");
  EXPECT_NE(message([](auto& o) { o.force = StrainGaugeOptions{.arm = 0.0}; }), "");
  EXPECT_NE(message([](auto& o) { o.acceleration = AccelerometerOptions<2>{.noise = -1.0}; }), "");
}

SensorOptions<1> silent_axis() {
  SensorOptions<1> options;
  options.encoder_resolution = 0.0;
  options.force = LoadCellOptions<1>{.white_noise = 0.0};
  options.acceleration = AccelerometerOptions<1>{.noise = 0.0};
  options.torque = MotorCurrentOptions<1>{};
  return options;
}

TrueState<1> axis_state() {
  TrueState<1> s;
  s.time = 1.5;
  s.theta[0] = s.motor_angle[0] = s.position[0] = 0.1234567;
  s.acceleration[0] = 3.0;
  s.force_hand_on_robot[0] = -1.7;
  s.motor_torque[0] = 0.4;
  return s;
}

SensorSuite<1> axis_suite(const SensorOptions<1>& options) {
  return SensorSuite<1>::create(options, {}, kTick, 1).value();
}

TEST(SensorSuiteOfOneAxis, PerfectOrSilentReadsTheTruthToTheLastBit) {
  for (const SensorOptions<1>& options : {SensorOptions<1>::perfect(), silent_axis()}) {
    SensorSuite<1> sensors = axis_suite(options);
    expect_truth(sensors.read(axis_state()), axis_state());
    EXPECT_EQ(sensors.next_interval(), kTick);
    EXPECT_EQ(sensors.clipped_samples(), 0);
    EXPECT_EQ(sensors.force_delay(), 0.0);
  }
}

TEST(SensorSuiteOfOneAxis, RecordsThePositionThatTheServoSees) {
  SensorOptions<1> options = silent_axis();
  options.encoder_resolution = 1e-3;
  SensorSuite<1> sensors = axis_suite(options);
  EXPECT_NEAR(sensors.encoders(axis_state().motor_angle)[0], 0.123, 1e-15);
  EXPECT_EQ(sensors.read(axis_state()).joint, sensors.encoders(axis_state().motor_angle));
}

TEST(SensorSuiteOfOneAxis, NoisesHaveTheirDeviations) {
  SensorOptions<1> options = silent_axis();
  options.force = LoadCellOptions<1>{.white_noise = 0.3, .coloured_noise = 0.4, .coloured_bandwidth = Hertz(100.0)};
  options.acceleration = AccelerometerOptions<1>{.noise = 0.05};
  SensorSuite<1> sensors = axis_suite(options);
  constexpr int kCount = 200000;
  double force = 0.0, acceleration = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const SensorSuite<1>::Reading reading = sensors.read(axis_state());
    force += std::pow(reading.force[0] + 1.7, 2) / kCount;
    acceleration += std::pow(reading.acceleration[0] - 3.0, 2) / kCount;
  }
  EXPECT_NEAR(force, 0.25, 5.0 * 0.25 * std::sqrt(4.0 / kCount));
  EXPECT_NEAR(acceleration, 0.0025, 5.0 * 0.0025 * std::sqrt(2.0 / kCount));
}

TEST(SensorSuiteOfOneAxis, AccelerometerThatIsTurnedAwaySeesTheCosine) {
  SensorOptions<1> options = silent_axis();
  options.acceleration = AccelerometerOptions<1>{.noise = 0.0, .misalignment = 0.2};
  EXPECT_NEAR(axis_suite(options).read(axis_state()).acceleration[0], 3.0 * std::cos(0.2), 1e-15);
}

TEST(SensorSuiteOfOneAxis, DriftsSteadilyWithoutNoise) {
  SensorOptions<1> options = silent_axis();
  options.force = LoadCellOptions<1>{.white_noise = 0.0, .drift_rate = AxisVector<1>(0.1)};
  SensorSuite<1> sensors = axis_suite(options);
  double force = 0.0;
  for (int k = 0; k <= 3000; ++k) force = sensors.read(axis_state()).force[0];
  EXPECT_NEAR(force, -1.7 + 0.3, 1e-14);
}

TEST(SensorSuiteOfOneAxis, RefusesWhatHasNoMeaning) {
  SensorOptions<1> options;
  options.force = LoadCellOptions<1>{.white_noise = -0.5};
  EXPECT_THAT(SensorSuite<1>::create(options, {}, kTick, 1).error().message,
              AllOf(HasSubstr("noise"), HasSubstr("-0.5 N")));
  options.force = LoadCellOptions<1>{.drift_rate = AxisVector<1>(std::numeric_limits<double>::infinity())};
  EXPECT_FALSE(SensorSuite<1>::create(options, {}, kTick, 1));
  EXPECT_FALSE(SensorSuite<1>::create({}, {}, -1.0, 1));
}

}  // namespace sensors_test
}  // namespace mbk::laboratory
