#include "mbk/model/robot/kinematics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/model/robot/test_postures.h"

namespace mbk::robot {
namespace kinematics_test {

using testing::HasSubstr;

constexpr double kRightAngle = 0.5 * std::numbers::pi;
constexpr double kLengthRounding = 1e-15;  // [m]: some units in the last place of half a metre
const Geometry kGeometry;

TEST(HandPosition, IsKnownWhereTheLinksLieAlongTheAxes) {
  // Both angles at zero: the first link along x, the last along −y (fig. A.1)
  EXPECT_TRUE(hand_position(kGeometry, {0.0, 0.0}).isApprox(Vector2d(0.254, -0.2667), kLengthRounding));
  EXPECT_TRUE(hand_position(kGeometry, {kRightAngle, kRightAngle}).isApprox(Vector2d(0.2667, 0.254), kLengthRounding));
  EXPECT_TRUE(elbow_position(kGeometry, {0.0, 1.0}).isApprox(Vector2d(0.254, 0.0), kLengthRounding));
}

TEST(HandPosition, IsTwoLinksFromTheBase) {
  for (const Vector2d& theta : postures(kGeometry.limits, 20)) {
    const Vector2d elbow = elbow_position(kGeometry, theta), hand = hand_position(kGeometry, theta);
    EXPECT_NEAR(elbow.norm(), kGeometry.d1, kLengthRounding);
    EXPECT_NEAR((hand - elbow).norm(), kGeometry.d2, kLengthRounding);
  }
}

TEST(JointAngles, UndoTheForwardKinematicsAllOverTheWorkspace) {
  for (const Vector2d& theta : postures(kGeometry.limits, 60)) {
    const auto back = joint_angles(kGeometry, hand_position(kGeometry, theta));
    ASSERT_TRUE(back) << back.error().line();
    // acos loses digits as its argument nears ±1, that is as the links come into one line
    const double kTolerance = 8.0 * std::numeric_limits<double>::epsilon() / std::abs(std::cos(theta[0] - theta[1]));
    EXPECT_LE((*back - theta).cwiseAbs().maxCoeff(), 2.0 * kTolerance + 1e-15) << theta.transpose();
  }
}

TEST(JointAngles, BringTheHandToItsPlace) {
  int reached = 0;
  for (double x = 0.02; x < 0.5; x += 0.04) {
    for (double y = -0.4; y < 0.45; y += 0.05) {
      const auto theta = joint_angles(kGeometry, {x, y});
      if (!theta) continue;
      ++reached;
      EXPECT_TRUE(hand_position(kGeometry, *theta).isApprox(Vector2d(x, y), 1e-13)) << x << " " << y;
    }
  }
  EXPECT_GT(reached, 50);
}

TEST(JointAngles, LieOnTheBranchWhoseElbowIsToTheLeftOfTheHand) {
  for (const Vector2d& theta : postures(kGeometry.limits, 20)) {
    const Vector2d hand = hand_position(kGeometry, theta);
    const auto found = joint_angles(kGeometry, hand);
    ASSERT_TRUE(found);
    const Vector2d elbow = elbow_position(kGeometry, *found);
    EXPECT_GT(hand.x() * elbow.y() - hand.y() * elbow.x(), 0.0) << theta.transpose();
  }
}

TEST(JointAngles, AStretchedArmReachesAsFarAsItsLinks) {
  const double reach = kGeometry.d1 + kGeometry.d2;
  const auto theta = joint_angles(kGeometry, {reach, 0.0});
  ASSERT_TRUE(theta) << theta.error().line();
  constexpr double kFlat = 1e-7;  // [rad]: acos near 1 turns a rounding of 1e-16 into its square root
  EXPECT_NEAR((*theta)[0], 0.0, kFlat);
  EXPECT_NEAR((*theta)[1], kRightAngle, kFlat);
}

TEST(JointAngles, RefuseWhatTheLinksDoNotReach) {
  for (const Vector2d& place : {Vector2d(0.6, 0.0), Vector2d(0.0, 0.0), Vector2d(0.0, -0.01)}) {
    const auto theta = joint_angles(kGeometry, place);
    ASSERT_FALSE(theta);
    EXPECT_EQ(theta.error().kind, ErrorKind::usage);
    EXPECT_THAT(theta.error().message, AllOf(HasSubstr("0.0127"), HasSubstr("0.5207 m")));
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(joint_angles(kGeometry, {nan, 0.2}));
  EXPECT_FALSE(joint_angles(kGeometry, {std::numeric_limits<double>::infinity(), 0.2}));
}

TEST(Jacobian, AgreesWithFiniteDifferences) {
  constexpr double kStep = 1e-5,
                   kTolerance = 1e-11;  // [m]: kStep²/6 of the third derivative, and rounding over 2 kStep
  for (const Vector2d& theta : postures(kGeometry.limits, 12)) {
    const Matrix2d J = jacobian(kGeometry, theta);
    for (int k = 0; k < 2; ++k) {
      const Vector2d step = kStep * Vector2d::Unit(k);
      const Vector2d difference =
          (hand_position(kGeometry, theta + step) - hand_position(kGeometry, theta - step)) / (2.0 * kStep);
      EXPECT_LE((J.col(k) - difference).norm(), 2.0 * kTolerance);
    }
  }
}

TEST(Jacobian, HasItsKnownDeterminant) {
  for (const Vector2d& theta : postures(kGeometry.limits, 12)) {
    EXPECT_NEAR(jacobian(kGeometry, theta).determinant(), -kGeometry.d1 * kGeometry.d2 * std::cos(theta[0] - theta[1]),
                1e-16);
  }
}

TEST(JacobianRate, AgreesWithFiniteDifferencesAlongAPath) {
  const auto path = [](double t) { return Vector2d(0.4 + 0.5 * std::sin(2.0 * t), 0.7 + 0.3 * std::cos(3.0 * t)); };
  const auto rate = [](double t) { return Vector2d(std::cos(2.0 * t), -0.9 * std::sin(3.0 * t)); };
  constexpr double kStep = 1e-5, kTolerance = 1e-9;  // [m/s]: kStep² times a third derivative of about 5
  for (double t = 0.0; t < 3.0; t += 0.1) {
    const Matrix2d difference =
        (jacobian(kGeometry, path(t + kStep)) - jacobian(kGeometry, path(t - kStep))) / (2.0 * kStep);
    EXPECT_LE((jacobian_rate(kGeometry, path(t), rate(t)) - difference).norm(), kTolerance) << t;
  }
}

TEST(JointLimits, AreThePublishedDegrees) {
  const double degree = std::numbers::pi / 180.0;
  EXPECT_DOUBLE_EQ(kGeometry.limits.theta1_low, -55.0 * degree);
  EXPECT_DOUBLE_EQ(kGeometry.limits.theta1_high, 90.0 * degree);
  EXPECT_DOUBLE_EQ(kGeometry.limits.theta2_low, 0.0);
  EXPECT_DOUBLE_EQ(kGeometry.limits.theta2_high, 145.0 * degree);
  EXPECT_DOUBLE_EQ(kGeometry.limits.smallest_opening, 35.0 * degree);
}

}  // namespace kinematics_test
}  // namespace mbk::robot
