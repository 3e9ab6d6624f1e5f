#include "mbk/model/robot/drive_terms.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "mbk/model/robot/friction.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/single_joint.h"

namespace mbk::robot {
namespace {

constexpr DriveTerms kEverything = {true, true, true, true, true, true};
constexpr double kEps = 2.3e-16;

std::vector<std::string> names(const DriveTerms& drive, const Mechanism& mechanism) {
  std::vector<std::string> all;
  for (const Coefficient& one : drive.coefficients(mechanism)) all.push_back(one.name + " in " + one.unit);
  return all;
}

TEST(DriveTerms, NameEachCoefficientJointByJointWithTheUnitOfTheJoint) {
  const DriveTerms drive{.coulomb = false, .cable = true};
  EXPECT_EQ(names(drive, PlanarMechanism({})),
            (std::vector<std::string>{"viscous_1 in N·m·s/rad", "cable_1 in N·m/rad", "offset_1 in N·m",
                                      "viscous_2 in N·m·s/rad", "cable_2 in N·m/rad", "offset_2 in N·m"}));
  EXPECT_EQ(names(drive, SingleJoint({})),
            (std::vector<std::string>{"viscous_1 in N·s/m", "cable_1 in N/m", "offset_1 in N"}));
}

TEST(DriveTerms, AreAsManyAsTheyName) {
  for (int which = 0; which < 64; ++which) {
    const auto bit = [which](int k) { return ((which >> k) & 1) != 0; };
    const DriveTerms drive{bit(0), bit(1), bit(2), bit(3), bit(4), bit(5)};
    EXPECT_EQ(drive.coefficients(PlanarMechanism({})).size(), 2U * static_cast<std::size_t>(drive.per_joint()));
  }
}

TEST(DriveTerms, FrictionIsThatOfTheSimulatedJoint) {
  const JointFriction friction{.viscous = 0.07, .coulomb = 0.11, .breakaway = 0.15};
  const DriveTerms drive{.stribeck = true, .offset = false};
  for (double velocity = -1.0; velocity <= 1.0; velocity += 0.013) {
    std::array<double, 3> row{};
    drive.regressor(0.4, velocity, 7.0, row.data());
    EXPECT_NEAR(0.07 * row[0] + 0.11 * row[1] + 0.04 * row[2], friction.torque(velocity), 4.0 * kEps);
  }
}

TEST(DriveTerms, WithoutSmoothingTakeTheSign) {
  const DriveTerms drive{.viscous = false, .offset = false, .smoothing = 0.0};
  for (const double velocity : {-1e-9, 0.0, 1e-9}) {
    double sign = 7.0;
    drive.regressor(0.0, velocity, 0.0, &sign);
    EXPECT_EQ(sign, static_cast<double>((velocity > 0.0) - (velocity < 0.0)));
  }
}

TEST(DriveTerms, OfAMotionAreThoseOfItsSamples) {
  for (int which = 0; which < 128; ++which) {
    const auto bit = [which](int k) { return ((which >> k) & 1) != 0; };
    DriveTerms drive{bit(0), bit(1), bit(2), bit(3), bit(4), bit(5)};
    if (bit(6)) drive.smoothing = 0.0;
    const Vector position = Vector::LinSpaced(301, -2.0, 2.0), velocity = Vector::LinSpaced(301, 0.9, -0.9),
                 acceleration = Vector::LinSpaced(301, -30.0, 10.0);
    Matrix rows = Matrix::Constant(301, drive.per_joint(), 7.0);
    drive.regressors(position, velocity, acceleration, rows);
    for (Index i = 0; i < rows.rows(); ++i) {
      Eigen::RowVectorXd row(rows.cols());
      drive.regressor(position[i], velocity[i], acceleration[i], row.data());
      ASSERT_TRUE(((rows.row(i) - row).array().abs() <= 4.0 * kEps).all()) << rows.row(i) << "\n" << row;
    }
  }
}

TEST(DriveTerms, OfAMotionStayFiniteAtAnySpeed) {
  Vector velocity(4);
  velocity << -1e300, -50.0, 50.0, 1e300;
  Matrix rows(4, 6);
  kEverything.regressors(velocity, velocity, velocity, rows);
  EXPECT_EQ(rows.col(2), (Vector(4) << -1.0, -1.0, 1.0, 1.0).finished());
  EXPECT_LT(rows.col(3).cwiseAbs().maxCoeff(), 1e-300);
}

}  // namespace
}  // namespace mbk::robot
