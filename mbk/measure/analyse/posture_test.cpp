#include "mbk/measure/analyse/posture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/model/robot/kinematics.h"

namespace mbk::analyse {
namespace posture_test {

using Eigen::Vector2d;
using testing::HasSubstr;

constexpr double kExact = 1e-12;  ///< [m]: a few operations on numbers near one

/// Four samples one second apart with the hand about a place.
Recording at(const Vector2d& hand) {
  Recording recording;
  recording.time = Vector::LinSpaced(4, 10.0, 13.0);
  Vector x(4), y(4);
  x << hand.x() + 5.0, hand.x() - 0.01, hand.x() + 0.01, std::numeric_limits<double>::quiet_NaN();
  y << hand.y() - 5.0, hand.y() + 0.02, hand.y() - 0.02, 1.0;
  recording.channels = {{"hand_x", "m", "base", x}, {"hand_y", "m", "base", y}};
  return recording;
}

Recording with_arm(const Vector2d& hand) {
  Recording recording = at(hand);
  recording.metadata = {{"shoulder_x_m", "0"}, {"shoulder_y_m", "-0.5"}, {"upper_arm_m", "0.3"}, {"forearm_m", "0.4"}};
  return recording;
}

TEST(Posture, TakesTheHandsMeanOverTheWindowAndLeavesOutWhatIsNoNumber) {
  const auto found = posture(at({0.3, -0.05}), 1.0, 3.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->of, ArmPosture::Of::hand);
  EXPECT_LT((found->points.back() - Vector2d(0.3, -0.05)).norm(), kExact);
  EXPECT_EQ(found->note, "");
}

TEST(Posture, OfATriangleOf3And4And5HasARightAngleAtTheElbowWhichIsToTheRight) {
  const auto found = posture(with_arm({0.0, 0.0}), 1.0, 2.0);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->of, ArmPosture::Of::arm);
  ASSERT_EQ(found->points.size(), 3U);
  EXPECT_LT((found->points[1] - Vector2d(0.24, -0.32)).norm(), kExact) << found->points[1];
}

TEST(Posture, HasTheElbowToTheLeftWhereTheMetadataSaySo) {
  Recording recording = with_arm({0.0, 0.0});
  recording.metadata["elbow"] = "left";
  const auto found = posture(recording, 1.0, 2.0);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->points.size(), 3U);
  EXPECT_LT((found->points[1] - Vector2d(-0.24, -0.32)).norm(), kExact) << found->points[1];
}

TEST(Posture, KeepsTheLinksLengthsWhereverTheHandIs) {
  for (const Vector2d& hand : {Vector2d(0.1, 0.05), Vector2d(-0.3, -0.2), Vector2d(0.05, -0.62)}) {
    const auto found = posture(with_arm(hand), 1.0, 2.0);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->of, ArmPosture::Of::arm) << hand.transpose() << " " << found->note;
    EXPECT_NEAR((found->points[1] - found->points[0]).norm(), 0.3, kExact);
    EXPECT_NEAR((found->points[2] - found->points[1]).norm(), 0.4, kExact);
  }
}

TEST(Posture, SaysWhyAnArmIsNotDrawn) {
  const auto note_with = [](const char* key, const char* value) {
    Recording recording = with_arm({0.0, 0.0});
    if (value == nullptr) {
      recording.metadata.erase(key);
    } else {
      recording.metadata[key] = value;
    }
    const auto found = posture(recording, 1.0, 2.0);
    EXPECT_EQ(found->of, ArmPosture::Of::hand);
    return found->note;
  };
  EXPECT_THAT(note_with("forearm_m", nullptr), HasSubstr("forearm_m"));
  EXPECT_THAT(note_with("forearm_m", "0,4"), HasSubstr("'0,4'"));
  EXPECT_THAT(note_with("upper_arm_m", "-0.3"), HasSubstr("'-0.3'"));
  EXPECT_THAT(note_with("shoulder_x_m", "nan"), HasSubstr("'nan'"));
  EXPECT_THAT(note_with("elbow", "up"), HasSubstr("'up'"));
  EXPECT_THAT(note_with("shoulder_y_m", "-0.75"), HasSubstr("0.4 m"));
  EXPECT_THAT(note_with("shoulder_y_m", "0"), HasSubstr("0.4 m"));
}

TEST(Posture, IsTheRobotsWhereItsJointsLeadToTheHand) {
  const robot::Geometry geometry;
  const Vector2d hand(0.3, -0.05);
  const auto angles = robot::joint_angles(geometry, hand);
  ASSERT_TRUE(angles);
  Recording recording = at(hand);
  recording.channels.push_back({"joint_1", "rad", "joint", Vector::Constant(4, (*angles)[0])});
  recording.channels.push_back({"joint_2", "rad", "joint", Vector::Constant(4, (*angles)[1])});
  auto found = posture(recording, 1.0, 3.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->of, ArmPosture::Of::robot);
  EXPECT_LT((found->points[1] - robot::elbow_position(geometry, *angles)).norm(), kExact);
  recording.channels.back().values.array() += 0.2;  // a robot of other lengths, or other angles
  found = posture(recording, 1.0, 3.0);
  EXPECT_EQ(found->of, ArmPosture::Of::hand);
}

TEST(Posture, IsAbsentWithoutAHandOrWithoutSamplesInTheWindow) {
  EXPECT_FALSE(posture(Recording{}, 0.0, 1.0));
  EXPECT_FALSE(posture(at({0.3, 0.0}), 100.0, 200.0));
  Recording one_axis = at({0.3, 0.0});
  one_axis.channels.pop_back();
  EXPECT_FALSE(posture(one_axis, 0.0, 3.0));
}

}  // namespace posture_test
}  // namespace mbk::analyse
