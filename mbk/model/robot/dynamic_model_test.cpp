#include "mbk/model/robot/dynamic_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <numbers>

#include "mbk/model/robot/single_joint.h"
#include "mbk/model/robot/test_models.h"
#include "mbk/model/robot/test_postures.h"
#include "tests/support/allocations.h"

namespace mbk::robot {
namespace dynamic_model_test {

constexpr double kRounding = 1e-14;  // of torques of some N·m

PlanarRobot robot_with_friction() {
  PlanarRobot robot;
  robot.friction[0].coulomb = 0.11;
  robot.friction[1] = {.viscous = 0.08, .coulomb = 0.1, .breakaway = 0.14};
  return robot;
}

TEST(DynamicModel, TorquesAreThoseOfTheRobotWithItsFriction) {
  const PlanarRobot robot = robot_with_friction();
  const JointMotion motion = Swing{}.sampled(2500, 1e-3);  // more than one piece
  const Matrix torque = model_of(robot).torques(motion);
  for (Index i = 0; i < motion.samples(); ++i) {
    const Vector2d expected = robot.motor_torque(motion.position.row(i).transpose(), motion.velocity.row(i).transpose(),
                                                 motion.acceleration.row(i).transpose(), Vector2d::Zero());
    ASSERT_LE((torque.row(i).transpose() - expected).norm(), kRounding) << "sample " << i;
  }
}

TEST(DynamicModel, TorquesAreRegressorsTimesParameters) {
  DynamicModel model = model_of(robot_with_friction());
  model.drive = {true, true, true, true, true, true};
  model.parameters = Vector::LinSpaced(15, 0.03, 0.4);
  const JointMotion motion = Swing{}.sampled(2500, 1e-3);
  const std::vector<Matrix> W = model.regressors(motion);
  const Matrix torque = model.torques(motion);
  ASSERT_EQ(W.size(), 2U);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    ASSERT_EQ(W[joint].cols(), static_cast<Index>(model.coefficients().size()));
    EXPECT_LE((W[joint] * model.parameters - torque.col(static_cast<Index>(joint))).cwiseAbs().maxCoeff(),
              100.0 * kRounding);
  }
}

TEST(DynamicModel, TorqueOfTheDrivesInOneStateIsThatOfTheMotion) {
  DynamicModel model = model_of(robot_with_friction());
  model.drive = {true, true, true, true, true, true};
  model.parameters = Vector::LinSpaced(15, 0.03, 0.4);
  DynamicModel without = model;
  without.parameters.tail(12).setZero();
  const JointMotion motion = Swing{}.sampled(100, 0.01);
  const Matrix drives = model.torques(motion) - without.torques(motion);
  const long before = testing_support::allocations();
  JointVector largest = JointVector::Zero(2);
  for (Index i = 0; i < motion.samples(); ++i) {
    const JointVector one = model.drive_torque(motion.position.row(i).transpose(), motion.velocity.row(i).transpose(),
                                               motion.acceleration.row(i).transpose());
    largest = largest.cwiseMax((one - drives.row(i).transpose()).cwiseAbs());
  }
  EXPECT_EQ(testing_support::allocations(), before);
  EXPECT_LE(largest.maxCoeff(), 100.0 * kRounding);
}

TEST(DynamicModel, NamesBodiesFirstAndThenTheDriveOfEachJoint) {
  const std::vector<Coefficient> all = model_of({}).coefficients();
  EXPECT_EQ(all[0].name, "alpha1");
  EXPECT_EQ(all[3].name, "viscous_1");
  EXPECT_EQ(all[8].name, "stribeck_2");
}

TEST(HandFromJoints, IsTheInverseOfTheTransposedJacobian) {
  const PlanarMechanism mechanism({});
  for (const Vector2d& q : postures(Geometry{}.limits, 20)) {
    if (std::abs(std::cos(q[0] - q[1])) < 0.01) continue;
    const auto L = hand_from_joints(mechanism, q);
    ASSERT_TRUE(L) << L.error().line();
    EXPECT_LE((*L * Matrix(jacobian(Geometry{}, q).transpose()) - Matrix2d::Identity()).norm(), 1e-9);  // condition 200
  }
}

TEST(HandFromJoints, WithMoreJointsThanAxesIsTheLeastSquaresInverse) {
  const ThreePointMasses mechanism;
  const JointVector q = Eigen::Vector3d(0.2, 0.7, -0.4);
  const Matrix transposed = mechanism.jacobian(q).transpose(), L = hand_from_joints(mechanism, q).value();
  const Matrix2d squared = transposed.transpose() * transposed;
  const Matrix pseudo_inverse = squared.inverse() * transposed.transpose();
  EXPECT_LE((L - pseudo_inverse).norm(), 1e-12);
  // A torque that no force at the hand answers does not show.
  const Eigen::Vector3d first = transposed.col(0), second = transposed.col(1);
  const Vector null = first.cross(second).normalized();
  EXPECT_LE((L * null).norm(), 1e-13);
}

/// Three joints in space, measured along x and z.
class SpatialArm : public ThreePointMasses {
 public:
  [[nodiscard]] HandJacobian jacobian_across(const JointVector& position) const override {
    return (HandJacobian(1, 3) << 0.3, 0.1 * std::cos(position[1]), -0.2).finished();
  }
};

TEST(HandFromJoints, TellsAPushAcrossTheHandsAxesApart) {
  const SpatialArm mechanism;
  for (const JointVector& q :
       {JointVector(Eigen::Vector3d(0.2, 0.7, -0.4)), JointVector(Eigen::Vector3d(-0.3, 1.1, 0.5))}) {
    const Matrix L = hand_from_joints(mechanism, q).value();
    EXPECT_LE((L * Matrix(mechanism.jacobian(q).transpose()) - Matrix2d::Identity()).norm(), 1e-10);
    EXPECT_LE((L * Matrix(mechanism.jacobian_across(q).transpose())).norm(), 1e-10);
    EXPECT_EQ(told_across(mechanism, q), 1);
  }
}

TEST(HandFromJoints, OfOneJointIsOne) {
  EXPECT_EQ(hand_from_joints(SingleJoint({}), JointVector::Constant(1, 0.3)).value()(0, 0), 1.0);
}

TEST(HandFromJoints, RefusesASingularPostureAndNamesIt) {
  const PlanarMechanism planar({});
  const auto folded = hand_from_joints(planar, Vector2d(0.5 * std::numbers::pi, 0.0));
  ASSERT_FALSE(folded);
  EXPECT_EQ(folded.error().kind, ErrorKind::data);
  EXPECT_THAT(folded.error().message, testing::HasSubstr("[1.571, 0]"));
  EXPECT_FALSE(hand_from_joints(ThreePointMasses{}, Eigen::Vector3d(0.3, 0.0, 0.0)));  // stretched
  EXPECT_FALSE(hand_from_joints(planar, Vector2d(std::numeric_limits<double>::quiet_NaN(), 0.0)));
}

TEST(HandFromJoints, DrawsTheLineAtAThousandthOfTheLargestSingularValue) {
  const PlanarMechanism planar({});
  const auto ratio = [](const Vector2d& q) {
    // σ₁ σ₂ = |det J| and σ₁² + σ₂² = ‖J‖²
    const Matrix2d J = jacobian(Geometry{}, q);
    const double product = std::abs(J.determinant()), half = 0.5 * J.squaredNorm();
    return product / (half + std::sqrt(half * half - product * product));
  };
  int refused = 0, allowed = 0;
  for (double from_folded = 1e-4; from_folded < 0.02; from_folded *= 1.07) {
    const Vector2d q(0.5 * std::numbers::pi - from_folded, 0.0);
    const bool regular = hand_from_joints(planar, q).has_value();
    EXPECT_EQ(regular, ratio(q) > 1e-3) << ratio(q);
    (regular ? allowed : refused) += 1;
  }
  EXPECT_GT(refused, 5);
  EXPECT_GT(allowed, 5);
}

TEST(RegularHandFromJoints, SaysTheSameWithoutWordsAndWithoutTheHeap) {
  const PlanarMechanism planar({});
  const ThreePointMasses redundant;
  const long before = testing_support::allocations();
  const auto L = regular_hand_from_joints(planar, Vector2d(0.4, 0.9));
  const auto wide = regular_hand_from_joints(redundant, Eigen::Vector3d(0.2, 0.7, -0.4));
  const auto none = regular_hand_from_joints(planar, Vector2d(0.5 * std::numbers::pi, 0.0));
  EXPECT_EQ(testing_support::allocations(), before);
  ASSERT_TRUE(L && wide);
  EXPECT_FALSE(none);
  EXPECT_EQ(*L, hand_from_joints(planar, Vector2d(0.4, 0.9)).value());
}

}  // namespace dynamic_model_test
}  // namespace mbk::robot
