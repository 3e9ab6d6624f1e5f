#include "mbk/measure/analyse/analyse_joint_domain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::analyse {
namespace analyse_joint_domain_test {

using Eigen::Vector2d;
using testing::HasSubstr;

constexpr double kExact = 1e-12;

/// Shoulder at the origin, a right angle at the elbow.
ArmPosture right_angle() {
  return {ArmPosture::Of::arm, {Vector2d(0.0, 0.0), Vector2d(0.3, 0.0), Vector2d(0.3, 0.4)}, ""};
}

Identification identification(const Vector2d& x0) {
  Identification id;
  id.model.M = (Matrix(2, 2) << 1.326, -0.935, -0.935, 1.883).finished();
  id.model.B = (Matrix(2, 2) << 5.76, -2.14, -2.14, 10.56).finished();
  id.model.K = (Matrix(2, 2) << 42.4, -20.9, -36.3, 125.3).finished();
  id.model.x0 = x0;
  id.covariance = Matrix::Zero(14, 14);
  std::mt19937 random(3);
  const Matrix root =
      Matrix(14, 14).unaryExpr([&](double /*none*/) { return static_cast<double>(random()) / 4294967296.0 - 0.5; });
  Vector scales(14);
  scales << 0.05, 0.05, 0.05, 0.05, 0.3, 0.3, 0.3, 0.3, 3.0, 3.0, 3.0, 3.0, 0.002, 0.002;
  id.covariance = scales.asDiagonal() * (root * root.transpose()) * scales.asDiagonal();
  return id;
}

TEST(JointDomain, OfARightAngleIsWorkedOutByHand) {
  // J = [[−0.4, −0.4], [0.3, 0]]; at rest without force K_q = JᵀKJ
  const Identification id = identification({0.3, 0.4});
  const JointDomain found = analyse_joint_domain(id, right_angle()).value();
  EXPECT_NEAR(found.jacobian.determinant(), 0.12, kExact);
  EXPECT_NEAR(found.angles[0], 0.0, kExact);
  EXPECT_NEAR(found.angles[1], std::numbers::pi / 2.0, kExact);
  EXPECT_NEAR(found.K(1, 1), 0.16 * 42.4, kExact);
  EXPECT_NEAR(found.K(0, 1), 0.16 * 42.4 - 0.12 * -36.3, kExact);
  EXPECT_NEAR(found.M(0, 0), 0.16 * 1.326 - 2.0 * 0.12 * -0.935 + 0.09 * 1.883, kExact);
  EXPECT_NEAR(found.k_a, 0.12 * 7.7, kExact);
  EXPECT_LT(found.bias_force.norm(), kExact);
}

TEST(JointDomain, OfAHandThatPushesOutwardIsStiffer) {
  // x₀ beyond the hand, along the straight line from the shoulder: the hand pushes outward
  const Vector2d hand(0.3, 0.4);
  Identification pushing = identification(hand);
  pushing.model.K = 100.0 * Matrix::Identity(2, 2);
  const Matrix rest = analyse_joint_domain(pushing, right_angle())->K;
  pushing.model.x0 = hand + Vector2d(0.03, 0.04);
  const JointDomain found = analyse_joint_domain(pushing, right_angle()).value();
  EXPECT_NEAR(found.bias_force.norm(), 5.0, kExact);
  // 5 N over the 0.5 m from shoulder to hand
  EXPECT_NEAR(found.K(0, 0) - rest(0, 0), 5.0 * 0.5, kExact);
}

TEST(JointDomain, ErrorsAreThoseOfAMonteCarlo) {
  const Identification id = identification({0.28, 0.42});
  const JointDomain found = analyse_joint_domain(id, right_angle()).value();
  const numeric::Cholesky factor(id.covariance);
  ASSERT_TRUE(factor.positive_definite());
  const Matrix root = factor.upper().transpose();
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 20000;
  Matrix values(kDraws, 7);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Vector change = root * Vector(14).unaryExpr([&](double /*none*/) { return normal(random); });
    Identification drawn = id;
    drawn.model = impedance::unstacked(impedance::stacked(id.model) + change, 2);
    const JointDomain one = analyse_joint_domain(drawn, right_angle()).value();
    values.row(draw) << one.M(0, 0), one.B(0, 1), one.K(0, 0), one.K(0, 1), one.K(1, 1), one.k_a, one.bias_force.x();
  }
  const Matrix centred = values.rowwise() - values.colwise().mean();
  const Vector spread = centred.cwiseAbs2().colwise().mean().cwiseSqrt().transpose();
  constexpr double kZ95 = 1.959963984540054;
  Vector expected(7);
  expected << found.M_error(0, 0), found.B_error(0, 1), found.K_error(0, 0), found.K_error(0, 1), found.K_error(1, 1),
      (found.k_a95.second - found.k_a95.first) / (2.0 * kZ95), found.bias_force_error.x();
  const double kDrawn = 0.03;  // 20,000 draws give a deviation to 0.5 %; K dx₀ is of second order, about 1 %
  for (Index k = 0; k < 7; ++k) EXPECT_NEAR(expected[k] / spread[k], 1.0, kDrawn) << "number " << k;
}

TEST(JointDomain, OfTheRobotHasItsJacobian) {
  const robot::Geometry geometry;
  const Vector2d theta(1.1, 0.7);
  const ArmPosture posture{
      ArmPosture::Of::robot,
      {Vector2d::Zero(), robot::elbow_position(geometry, theta), robot::hand_position(geometry, theta)},
      ""};
  const JointDomain found = analyse_joint_domain(identification(posture.points.back()), posture).value();
  EXPECT_LT((found.jacobian - robot::jacobian(geometry, theta)).norm(), kExact);
  EXPECT_LT((found.angles - theta).norm(), kExact);
  // Σ F ∂²x/∂q² by the rates of the robot's J: ∂J/∂θᵢ is J̇ for θ̇ᵢ = 1
  Identification pushing = identification(posture.points.back() + Vector2d(0.05, -0.02));
  const JointDomain pushed = analyse_joint_domain(pushing, posture).value();
  Eigen::Matrix2d curvature;
  for (Index i = 0; i < 2; ++i) {
    curvature.col(i) =
        robot::jacobian_rate(geometry, theta, Vector2d::Unit(i)).transpose() * Vector2d(pushed.bias_force);
  }
  const Matrix expected = found.jacobian.transpose() * pushing.model.K * found.jacobian - curvature;
  EXPECT_LT((pushed.K - expected).norm(), kExact);
}

TEST(JointDomain, WithoutACovarianceHasNoIntervals) {
  Identification id = identification({0.3, 0.4});
  id.covariance.setConstant(std::nan(""));
  const JointDomain found = analyse_joint_domain(id, right_angle()).value();
  EXPECT_TRUE(std::isnan(found.K_error(0, 0)));
  EXPECT_TRUE(std::isnan(found.k_a95.first));
  EXPECT_TRUE(found.K.allFinite());
}

TEST(JointDomain, RefusesAHandWithoutAnArmAndOneAxis) {
  const ArmPosture hand{
      ArmPosture::Of::hand, {Vector2d(0.3, 0.0)}, "the arm is not drawn: the metadata lack forearm_m"};
  EXPECT_THAT(analyse_joint_domain(identification({0.3, 0.0}), hand).error().message, HasSubstr("forearm_m"));
  Identification one = identification({0.3, 0.0});
  one.axes = 1;
  EXPECT_FALSE(analyse_joint_domain(one, right_angle()));
}

}  // namespace analyse_joint_domain_test
}  // namespace mbk::analyse
