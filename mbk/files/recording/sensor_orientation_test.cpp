#include "mbk/files/recording/sensor_orientation.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

namespace mbk::recording {
namespace sensor_orientation_test {

/// Whose force is (1, 2, 3) N in the base frame, measured by a sensor that turns with the time about (1, 1, 1).
Recording turning(double scale = 1.0) {
  constexpr Index kSamples = 50;
  Recording made;
  made.time = Vector::LinSpaced(kSamples, 0.0, 0.049);
  Matrix force(kSamples, 3), q(kSamples, 4);
  for (Index i = 0; i < kSamples; ++i) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(0.1 * static_cast<double>(i), Eigen::Vector3d::Ones().normalized()));
    force.row(i) = (turn.inverse() * Eigen::Vector3d(1.0, 2.0, 3.0)).transpose();
    q.row(i) = scale * turn.coeffs().transpose();
  }
  for (Index axis = 0; axis < 3; ++axis) {
    made.channels.push_back({std::string("force_") + "xyz"[axis], "N", "base", force.col(axis)});
  }
  for (Index part = 0; part < 4; ++part) {
    made.channels.push_back({std::string("sensor_q") + "xyzw"[part], "", "", q.col(part)});
  }
  return made;
}

TEST(SensorOrientation, TurnsTheForceToTheBaseSampleBySample) {
  Recording recording = turning();
  ASSERT_TRUE(turn_force_to_base(recording));
  ASSERT_EQ(recording.channels.size(), 3);
  for (Index axis = 0; axis < 3; ++axis) {
    const Vector& force = recording.channels.at(static_cast<std::size_t>(axis)).values;
    EXPECT_LT((force.array() - static_cast<double>(axis + 1)).abs().maxCoeff(), 1e-12) << axis;
  }
  EXPECT_EQ(recording.notes.size(), 1);
}

TEST(SensorOrientation, LeavesARecordingWithoutItAlone) {
  Recording recording = turning();
  recording.channels.resize(3);
  const Vector before = recording.channels[0].values;
  ASSERT_TRUE(turn_force_to_base(recording));
  EXPECT_EQ(recording.channels[0].values, before);
  EXPECT_TRUE(recording.notes.empty());
}

TEST(SensorOrientation, MustBeWhole) {
  Recording no_w = turning();
  no_w.channels.pop_back();
  const auto missing = turn_force_to_base(no_w);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().line(), testing::HasSubstr("sensor_qw is missing"));
  Recording no_force = turning();
  no_force.channels.erase(no_force.channels.begin() + 2);
  EXPECT_FALSE(turn_force_to_base(no_force));
  Recording too_long = turning(1.2);
  EXPECT_FALSE(turn_force_to_base(too_long));
  Recording unknown = turning();
  unknown.channels[4].values[7] = std::nan("");
  const auto at = turn_force_to_base(unknown);
  ASSERT_FALSE(at);
  EXPECT_THAT(at.error().line(), testing::HasSubstr("sample 8"));
}

}  // namespace sensor_orientation_test
}  // namespace mbk::recording
