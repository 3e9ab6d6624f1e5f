#include "mbk/simulate/participant/arm_geometry.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::participant {
namespace {

constexpr double kRounding = 1e-14;  // of lengths below 1 m through two angles
constexpr double kStep = 1e-5;       // central differences: error kStep²/6 and rounding/kStep, both near 1e-11

ArmGeometry turned_arm() {
  ArmGeometry geometry;
  geometry.shoulder = {0.1, -0.4};
  geometry.rotation = 0.7;
  return geometry;
}

TEST(ArmGeometry, ArmAheadIsTheClosedForm) {
  const Vector2d q = joint_angles({}, {0.30, -0.05});
  EXPECT_NEAR(std::cos(q[1]), (0.52 * 0.52 - 0.31 * 0.31 - 0.34 * 0.34) / (2.0 * 0.31 * 0.34), kRounding);
  EXPECT_LT((hand_position({}, q) - Vector2d(0.30, -0.05)).norm(), kRounding);
  EXPECT_GT(elbow_position({}, q).x(), 0.30);  // to the right of the line from shoulder to hand
  EXPECT_NEAR((elbow_position({}, q) - Vector2d(0.30, -0.57)).norm(), 0.31, kRounding);
  EXPECT_NEAR(jacobian({}, q).determinant(), 0.31 * 0.34 * std::sin(q[1]), kRounding);
}

TEST(ArmGeometry, AnglesOfAPlaceLeadBackToIt) {
  numeric::Random random(3);
  const ArmGeometry geometry = turned_arm();
  for (int i = 0; i < 200; ++i) {
    const Vector2d q(random.uniform(-1.5, 3.0), random.uniform(0.1, 3.0));  // all around but for straight behind
    EXPECT_LT((joint_angles(geometry, hand_position(geometry, q)) - q).norm(), 1e-12) << q.transpose();
  }
}

/// The documented formulas as they stand.
Vector2d angles_by_the_formulas(const ArmGeometry& geometry, const Vector2d& hand) {
  const double l1 = geometry.upper_arm, l2 = geometry.forearm;
  const Vector2d p = Eigen::Rotation2Dd(-geometry.rotation) * (hand - geometry.shoulder);
  const double cosine = std::clamp((p.squaredNorm() - l1 * l1 - l2 * l2) / (2.0 * l1 * l2), -1.0, 1.0);
  const double q2 = std::clamp(std::acos(cosine), kSmallestElbowAngle, std::numbers::pi - kSmallestElbowAngle);
  const double direction = 0.5 * std::numbers::pi - std::atan2(p.x(), p.y());
  return {direction - std::atan2(l2 * std::sin(q2), l1 + l2 * std::cos(q2)), q2};
}

TEST(ArmGeometry, APostureIsThatOfTheFormulasAllAroundAndBeyondReach) {
  numeric::Random random(5);
  int out_of_reach = 0, jumped = 0;
  for (int i = 0; i < 20000; ++i) {
    ArmGeometry geometry = turned_arm();
    geometry.rotation = random.uniform(-20.0, 20.0);
    const Vector2d hand = geometry.shoulder + Vector2d(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7));
    const Posture at = posture(geometry, hand);
    const Vector2d expected = angles_by_the_formulas(geometry, hand);
    ASSERT_LT((at.q - expected).norm(), 1e-11) << hand.transpose() << ", turned by " << geometry.rotation;
    ASSERT_LT(std::hypot(at.elbow.cosine - std::cos(at.q[1]), at.elbow.sine - std::sin(at.q[1])), 1e-13);
    const ArmLinks links = arm_links(geometry, at.q);
    ASSERT_LT((at.links.upper_arm - links.upper_arm).norm() + (at.links.forearm - links.forearm).norm(), 1e-13);
    const double r = (hand - geometry.shoulder).norm();
    out_of_reach += r > geometry.upper_arm + geometry.forearm || r < std::abs(geometry.upper_arm - geometry.forearm);
    jumped += at.q[0] < -0.5 * std::numbers::pi;
  }
  EXPECT_GT(out_of_reach, 1000);
  EXPECT_GT(jumped, 1000);
}

TEST(ArmGeometry, TheHandAtTheShoulderIsAPostureToo) {
  const ArmGeometry geometry = turned_arm();
  for (const double away : {0.0, 1e-200, 1e-13, 1e-11}) {
    const Posture at = posture(geometry, geometry.shoulder + Vector2d(0.0, away));
    EXPECT_DOUBLE_EQ(at.q[1], std::numbers::pi - kSmallestElbowAngle);
    EXPECT_NEAR(at.links.upper_arm.norm(), geometry.upper_arm, kRounding);
    EXPECT_NEAR(at.links.forearm.norm(), geometry.forearm, kRounding);
  }
  EXPECT_FALSE(posture(geometry, {std::nan(""), 0.0}).q.allFinite());
}

TEST(ArmGeometry, DerivativesAgreeWithDifferences) {
  const ArmGeometry geometry = turned_arm();
  const Vector2d q(0.4, 1.3), q_rate(0.8, -1.7), force(3.0, -2.0);
  const Matrix2d curvature = force_curvature(arm_links(geometry, q), force);
  for (int joint = 0; joint < 2; ++joint) {
    const Vector2d step = kStep * Vector2d::Unit(joint);
    const Vector2d slope = (hand_position(geometry, q + step) - hand_position(geometry, q - step)) / (2.0 * kStep);
    EXPECT_LT((jacobian(geometry, q).col(joint) - slope).norm(), 1e-9);
    const Vector2d bend =
        (jacobian(geometry, q + step) - jacobian(geometry, q - step)).transpose() * force / (2.0 * kStep);
    EXPECT_LT((curvature.col(joint) - bend).norm(), 1e-9);
  }
  const Matrix2d rate =
      (jacobian(geometry, q + kStep * q_rate) - jacobian(geometry, q - kStep * q_rate)) / (2.0 * kStep);
  EXPECT_LT((jacobian_rate(geometry, q, q_rate) - rate).norm(), 1e-9);
}

TEST(ArmGeometry, TurningTheAxesTurnsTheArmAboutTheShoulder) {
  ArmGeometry straight = turned_arm();
  straight.rotation = 0.0;
  const Vector2d q(0.4, 1.3);
  const Vector2d reach = hand_position(straight, q) - straight.shoulder;
  EXPECT_LT((hand_position(turned_arm(), q) - straight.shoulder - Eigen::Rotation2Dd(0.7) * reach).norm(), kRounding);
}

TEST(ArmGeometry, OutOfReachKeepsAnInvertibleJacobian) {
  for (const Vector2d& place : {Vector2d(0.3, 0.6), Vector2d(0.3, -0.57), Vector2d(5.0, 5.0)}) {
    const Vector2d q = joint_angles({}, place);
    EXPECT_TRUE(q.allFinite());
    EXPECT_GE(std::abs(jacobian({}, q).determinant()), 0.99 * 0.31 * 0.34 * std::sin(kSmallestElbowAngle));
  }
}

}  // namespace
}  // namespace mbk::participant
