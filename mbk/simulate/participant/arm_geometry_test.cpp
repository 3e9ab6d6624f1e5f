#include "mbk/simulate/participant/arm_geometry.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
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

TEST(ArmGeometry, DerivativesAgreeWithDifferences) {
  const ArmGeometry geometry = turned_arm();
  const Vector2d q(0.4, 1.3), q_rate(0.8, -1.7), force(3.0, -2.0);
  const Matrix2d curvature = force_curvature(geometry, q, force);
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
