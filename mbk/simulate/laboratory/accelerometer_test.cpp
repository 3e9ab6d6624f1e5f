#include "mbk/simulate/laboratory/accelerometer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mbk::laboratory {
namespace accelerometer_test {

using Eigen::Vector2d;

constexpr double kTick = 1e-3;

TEST(Accelerometer, WithEverythingOffAddsNothing) {
  Accelerometer<2> sensor = Accelerometer<2>::create({.noise = 0.0}, kTick, 1).value();
  EXPECT_EQ(sensor.added({3.1, -0.7}), Vector2d::Zero());
}

TEST(Accelerometer, AddsBiasAndGainError) {
  Accelerometer<2> sensor =
      Accelerometer<2>::create({.noise = 0.0, .bias = {0.2, -0.1}, .gain_error = {0.02, -0.05}}, kTick, 1).value();
  EXPECT_LT((sensor.added({3.0, 4.0}) - Vector2d(0.2 + 0.06, -0.1 - 0.2)).norm(), 1e-14);
}

TEST(Accelerometer, TurnedToTheLeftSeesAccelerationAlongTheLinkToItsRight) {
  const double angle = 0.1;
  Accelerometer<2> sensor = Accelerometer<2>::create({.noise = 0.0, .misalignment = angle}, kTick, 1).value();
  const Vector2d reading = sensor.added({2.0, 0.0}) + Vector2d(2.0, 0.0);
  EXPECT_LT((reading - 2.0 * Vector2d(std::cos(angle), -std::sin(angle))).norm(), 1e-14);
}

TEST(Accelerometer, HasHalfThePowerAtItsBandwidth) {
  const double frequency = 50.0;
  Accelerometer<2> sensor = Accelerometer<2>::create({.noise = 0.0, .bandwidth = Hertz(frequency)}, kTick, 1).value();
  double square = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const Vector2d a(std::sin(2.0 * M_PI * frequency * k * kTick), 0.0);
    const double reading = sensor.added(a)[0] + a[0];
    if (k >= 1000) square += reading * reading / 1000.0;
  }
  EXPECT_NEAR(square, 0.25, 1e-12);  // half of a sine's ½
}

TEST(Accelerometer, NoiseHasItsDeviation) {
  Accelerometer<2> sensor = Accelerometer<2>::create({.noise = 0.05}, kTick, 1).value();
  constexpr int kCount = 100000;
  Vector2d square = Vector2d::Zero();
  for (int k = 0; k < kCount; ++k) square += sensor.added({1.0, 1.0}).cwiseAbs2() / kCount;
  for (const double value : square) EXPECT_NEAR(value, 0.0025, 5.0 * 0.0025 * std::sqrt(2.0 / kCount));
}

TEST(Accelerometer, RefusesWhatHasNoMeaning) {
  EXPECT_THAT(Accelerometer<2>::create({.noise = -1.0}, kTick, 1).error().message,
              AllOf(testing::HasSubstr("noise"), testing::HasSubstr("-1 m/s²")));
  EXPECT_FALSE(Accelerometer<2>::create({.gain_error = {-1.0, 0.0}}, kTick, 1));
  EXPECT_FALSE(Accelerometer<2>::create({.misalignment = std::numeric_limits<double>::quiet_NaN()}, kTick, 1));
  EXPECT_FALSE(Accelerometer<2>::create({.bandwidth = Hertz(500.0)}, kTick, 1));
}

}  // namespace accelerometer_test
}  // namespace mbk::laboratory
