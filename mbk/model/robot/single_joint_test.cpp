#include "mbk/model/robot/single_joint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace mbk::robot {
namespace single_joint_test {

JointVector one(double value) {
  return JointVector::Constant(1, value);
}

TEST(SingleJoint, TorqueIsItsInertiaTimesTheAccelerationWhateverElseItDoes) {
  const SingleJoint drive({});
  Matrix Y(1, 1);
  for (const double velocity : {-3.0, 0.0, 2.0}) {
    drive.regressor(one(0.7), one(velocity), one(4.0), Y);
    EXPECT_EQ(Y(0, 0), 4.0);
  }
}

TEST(SingleJoint, TermsAreThoseOfDifferencesOfTheRegressor) {
  const SingleJoint drive({});
  const Vector phi = Vector::Constant(1, 2.5);
  const JointTerms own = drive.terms(one(0.3), one(1.5), phi), plain = drive.Mechanism::terms(one(0.3), one(1.5), phi);
  EXPECT_EQ(own.inertia(0, 0), 2.5);
  EXPECT_EQ(own.inertia, plain.inertia);
  EXPECT_EQ(own.coriolis_transposed, plain.coriolis_transposed);
  EXPECT_EQ(own.gravity, plain.gravity);
}

TEST(SingleJoint, NamesAMassWhereItSlidesAndAnInertiaWhereItTurns) {
  EXPECT_EQ(SingleJoint({.slides = true}).coefficients()[0].unit, "kg");
  EXPECT_EQ(SingleJoint({.slides = false}).coefficients()[0].unit, "kg·m²");
}

TEST(SingleJoint, HandIsTheJoint) {
  const SingleJoint drive({});
  EXPECT_EQ(drive.hand_position(one(0.4))[0], 0.4);
  EXPECT_EQ(drive.jacobian(one(0.4))(0, 0), 1.0);
  EXPECT_EQ(drive.jacobian_rate(one(0.4), one(1.0))(0, 0), 0.0);
}

TEST(SingleJoint, RefusesPlacesBeyondItsLimitsAndThoseThatAreNoNumbers) {
  const SingleJoint drive({.slides = true, .low = -0.1, .high = 0.2});
  EXPECT_TRUE(drive.check_joints(one(0.2)));
  const auto beyond = drive.check_joints(one(0.3));
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().message, AllOf(testing::HasSubstr("0.3 m"), testing::HasSubstr("0.2 m")));
  EXPECT_FALSE(drive.check_joints(one(std::numeric_limits<double>::quiet_NaN())));
}

TEST(SingleJoint, StandsInTheMiddleOfItsLimits) {
  EXPECT_NEAR(SingleJoint({.slides = true, .low = -0.1, .high = 0.2}).postures(5)[0][0], 0.05, 1e-15);
}

}  // namespace single_joint_test
}  // namespace mbk::robot
