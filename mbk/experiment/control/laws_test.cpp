#include "mbk/experiment/control/laws.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "tests/support/allocations.h"

namespace mbk::control {
namespace laws_test {

constexpr double kTick = 1e-3;
constexpr double kRounding = 1e-12;  // torques of a few N·m, through a handful of operations
const Vector2d kHome(0.30, -0.05);

const robot::Geometry& geometry() {
  static const robot::Geometry geometry;
  return geometry;
}

Vector2d home_angles() {
  return robot::joint_angles(geometry(), kHome).value();
}

TEST(JointPositionControl, IsProportionalToTheErrorOfAJointAtRest) {
  auto law = JointPositionControl::create({}, kTick).value();
  const Vector2d error(0.02, -0.01), measured = home_angles();
  for (int i = 0; i < 3; ++i) {
    const Vector2d torque = law.step(measured, measured + error, Vector2d::Zero());
    EXPECT_LT((torque - 60.0 * error).norm(), kRounding);
  }
}

TEST(JointPositionControl, OpposesVelocityAgainstThatOfTheReference) {
  JointPositionControl::Gains gains;
  gains.proportional.setZero();
  auto law = JointPositionControl::create(gains, kTick).value();
  const Vector2d rate(0.5, -0.4);
  Vector2d torque;
  for (int i = 0; i < 100; ++i) torque = law.step(i * kTick * rate, Vector2d::Zero(), rate);
  EXPECT_LT(torque.norm(), 1e-9);  // moving as it should
  for (int i = 100; i < 200; ++i) torque = law.step(i * kTick * rate, Vector2d::Zero(), Vector2d::Zero());
  EXPECT_LT((torque + 1.5 * rate).norm(), 1e-9);
}

TEST(ForceControl, DoesTheWorkOfItsForceInEveryPosture) {
  const ForceControl law(geometry());
  const Vector2d force(3.0, -1.5);
  for (double x = 0.2; x < 0.4; x += 0.05) {
    for (double y = -0.1; y < 0.1; y += 0.05) {
      const Vector2d theta = robot::joint_angles(geometry(), {x, y}).value(), rate(0.7, -0.2);
      const double at_joints = law.step(theta, force).dot(rate);
      EXPECT_NEAR(at_joints, force.dot(robot::jacobian(geometry(), theta) * rate), kRounding);
    }
  }
}

/// The force at the hand behind a torque.
Vector2d hand_force(const Vector2d& theta, const Vector2d& torque) {
  const Matrix2d J = robot::jacobian(geometry(), theta);
  return J.transpose().inverse() * torque;
}

TEST(LineConstraint, AppliesAForceAlongTheLineAsItIs) {
  LineConstraint::Options options;
  options.through = kHome;
  auto law = LineConstraint::create(options, geometry(), kTick).value();
  EXPECT_LT((hand_force(home_angles(), law.step(home_angles(), {5.0, 2.0})) - Vector2d(0.0, 2.0)).norm(), 1e-10);
}

TEST(LineConstraint, PullsBackAcrossTheLineAndNotAlongIt) {
  LineConstraint::Options options;
  options.through = kHome;
  auto law = LineConstraint::create(options, geometry(), kTick).value();
  const Vector2d theta = robot::joint_angles(geometry(), kHome + Vector2d(0.001, 0.03)).value();
  const Vector2d force = hand_force(theta, law.step(theta, Vector2d::Zero()));
  EXPECT_LT((force - Vector2d(-4.0, 0.0)).norm(), 1e-9);  // −4000 N/m · 1 mm
}

TEST(LineConstraint, TurnsWithItsAngle) {
  LineConstraint::Options options;
  options.through = kHome;
  options.angle = std::numbers::pi / 4.0;
  auto law = LineConstraint::create(options, geometry(), kTick).value();
  const Vector2d along(std::sqrt(0.5), std::sqrt(0.5));
  const Vector2d force = hand_force(home_angles(), law.step(home_angles(), {2.0, 0.0}));
  EXPECT_LT((force - along * along.dot(Vector2d(2.0, 0.0))).norm(), 1e-10);
}

TEST(Laws, DoNotAllocate) {
  auto position = JointPositionControl::create({}, kTick).value();
  auto line = LineConstraint::create({}, geometry(), kTick).value();
  const ForceControl force(geometry());
  const Vector2d theta = home_angles();
  const long before = testing_support::allocations();
  Vector2d sum = Vector2d::Zero();
  for (int i = 0; i < 100; ++i) {
    sum += position.step(theta, theta, Vector2d::Zero()) + line.step(theta, {1.0, 1.0}) + force.step(theta, {1.0, 1.0});
  }
  EXPECT_EQ(testing_support::allocations(), before) << sum;
  const auto counted = std::make_unique<double>(1.0);
  EXPECT_GT(testing_support::allocations(), before) << "the counter counts: " << *counted;
}

TEST(Laws, RefuseGainsAndTimesThatAreNone) {
  JointPositionControl::Gains gains;
  gains.derivative[1] = -1.0;
  const std::string refused = JointPositionControl::create(gains, kTick).error().message;
  EXPECT_NE(refused.find("-1 N·m·s/rad"), std::string::npos) << refused;
  EXPECT_FALSE(JointPositionControl::create({}, 0.0));
  LineConstraint::Options options;
  options.stiffness = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(LineConstraint::create(options, geometry(), kTick));
}

}  // namespace laws_test
}  // namespace mbk::control
