#include "mbk/simulate/laboratory/one_axis_sensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mbk::laboratory {
namespace {

constexpr double kTick = 1e-3;

OneAxisSensorOptions silent() {
  return {.position_resolution = 0.0, .reaction_noise = 0.0, .acceleration_noise = 0.0};
}

const OneAxisTrueState kState{.time = 1.5, .position = 0.1234567, .acceleration = 3.0, .reaction = -1.7};

TEST(OneAxisSensors, WithEverythingOffReadTheTruth) {
  OneAxisSensors sensors = OneAxisSensors::create(silent(), kTick, 1).value();
  const OneAxisSensors::Reading reading = sensors.read(kState);
  EXPECT_EQ(reading.time, 1.5);
  EXPECT_EQ(reading.position, 0.1234567);
  EXPECT_EQ(reading.reaction, -1.7);
  EXPECT_EQ(reading.acceleration, 3.0);
}

TEST(OneAxisSensors, RecordThePositionThatTheServoSees) {
  OneAxisSensorOptions options = silent();
  options.position_resolution = 1e-3;
  OneAxisSensors sensors = OneAxisSensors::create(options, kTick, 1).value();
  EXPECT_NEAR(sensors.position(kState.position), 0.123, 1e-15);
  EXPECT_EQ(sensors.read(kState).position, sensors.position(kState.position));
}

TEST(OneAxisSensors, NoisesHaveTheirDeviations) {
  OneAxisSensorOptions options = silent();
  options.reaction_noise = 0.3;
  options.coloured_noise = 0.4;
  options.coloured_bandwidth = Hertz(100.0);
  options.acceleration_noise = 0.05;
  OneAxisSensors sensors = OneAxisSensors::create(options, kTick, 1).value();
  constexpr int kCount = 200000;
  double reaction = 0.0, acceleration = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const OneAxisSensors::Reading reading = sensors.read(kState);
    reaction += std::pow(reading.reaction + 1.7, 2) / kCount;
    acceleration += std::pow(reading.acceleration - 3.0, 2) / kCount;
  }
  EXPECT_NEAR(reaction, 0.25, 5.0 * 0.25 * std::sqrt(4.0 / kCount));
  EXPECT_NEAR(acceleration, 0.0025, 5.0 * 0.0025 * std::sqrt(2.0 / kCount));
}

TEST(OneAxisSensors, DriftSteadilyWithoutNoise) {
  OneAxisSensorOptions options = silent();
  options.drift_rate = 0.1;
  OneAxisSensors sensors = OneAxisSensors::create(options, kTick, 1).value();
  double reaction = 0.0;
  for (int k = 0; k <= 3000; ++k) reaction = sensors.read(kState).reaction;
  EXPECT_NEAR(reaction, -1.7 + 0.3, 1e-14);
}

TEST(OneAxisSensors, RefuseNegativeNoise) {
  OneAxisSensorOptions options;
  options.reaction_noise = -0.5;
  EXPECT_EQ(OneAxisSensors::create(options, kTick, 1).error().message,
            "reaction noise -0.5 N·m or N is below zero or not finite");
  options = {};
  options.drift_rate = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(OneAxisSensors::create(options, kTick, 1));
  EXPECT_FALSE(OneAxisSensors::create({}, -1.0, 1));
}

}  // namespace
}  // namespace mbk::laboratory
