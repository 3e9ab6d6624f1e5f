#include "mbk/measure/analyse/axis_maps.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

/// Symmetric and positive definite, of any size and orientation.
Matrix random_stiffness(numeric::Random& random, Index axes = 2) {
  Matrix A(axes, axes);
  for (double& value : A.reshaped()) value = random.normal();
  return A * A.transpose() + 0.2 * Matrix::Identity(axes, axes);
}

Measurement measured(const Matrix& R, const impedance::Model& model, double relative_error) {
  Measurement result;
  Identification& id = result.identification;
  const Index n = R.rows();
  id.axes = static_cast<int>(n);
  id.model = {R * model.M, R * model.B, R * model.K, Vector::Zero(n)};
  id.covariance = Matrix::Zero(3 * n * n + n, 3 * n * n + n);
  for (Index part = 0; part < 3; ++part) {
    const Matrix& Z = part == 0 ? model.M : part == 1 ? model.B : model.K;
    const double error = relative_error * Z.norm();
    id.covariance.diagonal().segment(n * n * part, n * n).setConstant(error * error);
  }
  id.standard_error = impedance::unstacked(id.covariance.diagonal().cwiseSqrt(), n);
  return result;
}

/// Channels read from columns 2 to 5, or 2 to 7.
Recording recording(int axes) {
  Recording result;
  int column = 2;
  for (const auto& [quantity, prefix] : {std::pair(kPositionChannels, ""), std::pair(kForceChannels, "F")}) {
    for (int axis = 0; axis < axes; ++axis) {
      const std::string alias = fmt::format("{}{}", prefix, "xyz"[axis]);
      result.channels.push_back(
          {quantity.name(axes, axis), "", "base", Vector::Zero(1), {alias, std::to_string(column++), "", ""}});
    }
  }
  return result;
}

std::optional<Warning> checked(const Measurement& one) {
  const Recording from = recording(one.identification.axes);
  PreparedTrial trial;
  trial.axes = one.identification.axes;
  return check_axes({&from}, {trial}, one);
}

TEST(AxisMaps, EachOfTheEightIsFoundAndNamed) {
  constexpr double kRelativeError = 0.01;
  numeric::Random random(1);
  const struct {
    Eigen::Matrix2d R;
    const char* channels;
  } maps[] = {
      {(Eigen::Matrix2d() << -1, 0, 0, 1).finished(), "x=2,y=3,Fx=-4,Fy=5"},
      {(Eigen::Matrix2d() << 1, 0, 0, -1).finished(), "x=2,y=3,Fx=4,Fy=-5"},
      {(Eigen::Matrix2d() << -1, 0, 0, -1).finished(), "x=2,y=3,Fx=-4,Fy=-5"},
      {(Eigen::Matrix2d() << 0, 1, 1, 0).finished(), "x=2,y=3,Fx=5,Fy=4"},
      {(Eigen::Matrix2d() << 0, -1, -1, 0).finished(), "x=2,y=3,Fx=-5,Fy=-4"},
      {(Eigen::Matrix2d() << 0, -1, 1, 0).finished(), "x=2,y=3,Fx=5,Fy=-4"},
      {(Eigen::Matrix2d() << 0, 1, -1, 0).finished(), "x=2,y=3,Fx=-5,Fy=4"},
  };
  for (int k = 0; k < 100; ++k) {
    const impedance::Model model = {random_stiffness(random), random_stiffness(random), random_stiffness(random),
                                    Vector::Zero(2)};
    EXPECT_FALSE(checked(measured(Eigen::Matrix2d::Identity(), model, kRelativeError))) << k;
    for (const auto& map : maps) {
      const auto found = checked(measured(map.R, model, kRelativeError));
      ASSERT_TRUE(found) << k << " " << map.channels;
      EXPECT_NE(found->remedy.find(map.channels), std::string::npos) << k << ": " << found->remedy;
    }
  }
}

TEST(AxisMaps, EveryMapOfThreeAxesIsFound) {
  numeric::Random random(4);
  const impedance::Model model = {random_stiffness(random, 3), random_stiffness(random, 3), random_stiffness(random, 3),
                                  Vector::Zero(3)};
  EXPECT_FALSE(checked(measured(Matrix::Identity(3, 3), model, 0.01)));
  std::array<Index, 3> from = {0, 1, 2};
  int maps = 0;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix R = Matrix::Zero(3, 3);
      std::string channels = "x=2,y=3,z=4";
      for (Index i = 0; i < 3; ++i) R(from[static_cast<std::size_t>(i)], i) = ((signs >> i) & 1) != 0 ? -1.0 : 1.0;
      if (R.isIdentity()) continue;
      for (Index i = 0; i < 3; ++i) {
        const Index column = from[static_cast<std::size_t>(i)];
        channels += fmt::format(",F{}={}{}", "xyz"[i], R(column, i) < 0.0 ? "-" : "", 5 + column);
      }
      const auto found = checked(measured(R, model, 0.005));
      ASSERT_TRUE(found) << R;
      EXPECT_NE(found->remedy.find(channels), std::string::npos) << channels << ": " << found->remedy;
      ++maps;
    }
  } while (std::next_permutation(from.begin(), from.end()));
  EXPECT_EQ(maps, 47);
}

TEST(AxisMaps, NothingIsSaidOfNoise) {
  numeric::Random random(2);
  for (int k = 0; k < 200; ++k) {
    impedance::Model model;
    for (Matrix* Z : {&model.M, &model.B, &model.K}) {
      Z->resize(2, 2);
      for (double& value : Z->reshaped()) value = random.normal();
    }
    model.x0 = Vector::Zero(2);
    EXPECT_FALSE(checked(measured(Eigen::Matrix2d::Identity(), model, 2.0))) << k;
  }
}

TEST(AxisMaps, AForceThatIsTurnedIsNamedByItsAngle) {
  numeric::Random random(3);
  const impedance::Model model = {random_stiffness(random), random_stiffness(random), random_stiffness(random),
                                  Vector::Zero(2)};
  const auto found = checked(measured(Eigen::Rotation2D<double>(0.6).toRotationMatrix(), model, 0.01));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->code, WarningCode::axes_mismatched);
  EXPECT_NE(found->message.find("34°"), std::string::npos) << found->message;
}

impedance::Model relaxed_arm() {
  return {Matrix{{1.326, -0.935}, {-0.935, 1.883}}, Matrix{{5.76, -2.14}, {-2.14, 10.56}},
          Matrix{{42.4, -28.6}, {-28.6, 125.3}}, Vector::Zero(2)};
}

TEST(Symmetry, OfAForceThatIsTurnedByLessTheAngleIsNamedWithWhatTurnsItBack) {
  for (const double degrees : {-15.0, 4.0, 12.0}) {
    const Matrix turn = Eigen::Rotation2D<double>(degrees / kDegrees).toRotationMatrix();
    const Measurement one = measured(turn, relaxed_arm(), 0.005);
    EXPECT_FALSE(checked(one)) << degrees;
    const auto found = check_symmetry(one);
    ASSERT_TRUE(found) << degrees;
    EXPECT_EQ(found->code, WarningCode::inertia_not_symmetric);
    EXPECT_NE(found->message.find(fmt::format("{:.1f}°", degrees)), std::string::npos) << found->message;
    EXPECT_NE(found->remedy.find(fmt::format("--force-rotation-deg {:.1f};", -degrees)), std::string::npos)
        << found->remedy;
  }
}

impedance::Model relaxed_arm_in_space() {
  return {Matrix{{1.3, -0.9, 0.1}, {-0.9, 1.9, 0.2}, {0.1, 0.2, 1.4}},
          Matrix{{5.8, -2.1, 0.5}, {-2.1, 10.6, 1.0}, {0.5, 1.0, 8.0}},
          Matrix{{42.0, -28.0, 5.0}, {-28.0, 125.0, 9.0}, {5.0, 9.0, 90.0}}, Vector::Zero(3)};
}

TEST(Symmetry, NamesTheRotationVectorOfAForceThatIsTurnedInSpace) {
  numeric::Random random(5);
  for (const double degrees : {5.0, 8.0, 15.0}) {
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d axis = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
      const Matrix turn = Eigen::AngleAxisd(degrees / kDegrees, axis).toRotationMatrix();
      const auto found = check_symmetry(measured(turn, relaxed_arm_in_space(), 0.003));
      ASSERT_TRUE(found) << degrees << " about " << axis.transpose();
      EXPECT_EQ(found->code, WarningCode::inertia_not_symmetric);
      EXPECT_NE(found->message.find(fmt::format("{:.1f}°", degrees)), std::string::npos) << found->message;
      const Eigen::Vector3d back = -degrees * axis;
      EXPECT_NE(
          found->remedy.find(fmt::format("--force-rotation-deg {:.1f},{:.1f},{:.1f};", back[0], back[1], back[2])),
          std::string::npos)
          << found->remedy << " for " << back.transpose();
    }
  }
  EXPECT_FALSE(check_symmetry(measured(Matrix::Identity(3, 3), relaxed_arm_in_space(), 0.003)));
}

TEST(Symmetry, NamesTheGainOfAForceAxis) {
  for (const double gain : {0.6, 1.5}) {
    const auto in_plane = check_symmetry(measured(Matrix(Vector{{1.0, gain}}.asDiagonal()), relaxed_arm(), 0.005));
    ASSERT_TRUE(in_plane) << gain;
    EXPECT_NE(in_plane->message.find(fmt::format("Fy were {:.3g} ±", gain)), std::string::npos) << in_plane->message;
    const auto in_space =
        check_symmetry(measured(Matrix(Vector{{1.0, 1.0, gain}}.asDiagonal()), relaxed_arm_in_space(), 0.001));
    ASSERT_TRUE(in_space) << gain;
    EXPECT_NE(in_space->message.find("Fy were 1 ±"), std::string::npos) << in_space->message;
    EXPECT_NE(in_space->message.find(fmt::format("Fz were {:.3g} ±", gain)), std::string::npos) << in_space->message;
  }
}

TEST(AxisMaps, AForceThatIsTurnedInSpaceIsNamedByItsAngleAndAxis) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 2.0, -1.0).normalized();
  const Matrix turn = Eigen::AngleAxisd(0.6, axis).toRotationMatrix();
  const auto found = checked(measured(turn, relaxed_arm_in_space(), 0.005));
  ASSERT_TRUE(found);
  EXPECT_NE(found->message.find("34° about [0.41, 0.82, -0.41]"), std::string::npos) << found->message;
}

TEST(Symmetry, CountsTheHandleThatTheTurnedSensorCarries) {
  const Matrix turn = Eigen::Rotation2D<double>(12.0 / kDegrees).toRotationMatrix();
  impedance::Model with_handle = relaxed_arm();
  with_handle.M.diagonal().array() += 0.6;
  Measurement one = measured(turn, with_handle, 1e-3);
  one.identification.handle_mass = 0.6;
  one.identification.model.M.diagonal().array() -= 0.6;
  const auto found = check_symmetry(one);
  ASSERT_TRUE(found);
  EXPECT_NE(found->message.find("12.0°"), std::string::npos) << found->message;
}

TEST(Symmetry, ToleratesStiffnessAndDampingThatAreNotSymmetric) {
  impedance::Model reflex = relaxed_arm();
  reflex.K(0, 1) += 20.0;
  reflex.K(1, 0) -= 20.0;
  EXPECT_FALSE(check_symmetry(measured(Matrix::Identity(2, 2), reflex, 0.005)));
}

TEST(Symmetry, NamesAGainOfOneAxisWhereThatIsTheCause) {
  const Matrix gain = Eigen::Vector2d(1.0, 1.3).asDiagonal();
  const auto found = check_symmetry(measured(gain, relaxed_arm(), 0.003));
  ASSERT_TRUE(found);
  EXPECT_NE(found->message.find("Fy"), std::string::npos) << found->message;
  EXPECT_NE(found->message.find(" 1.3 "), std::string::npos) << found->message;
  EXPECT_EQ(found->message.find("°"), std::string::npos) << found->message;
}

TEST(Symmetry, AsksBothMethodsWhereBothAreUsable) {
  const Matrix turn = Eigen::Rotation2D<double>(0.2).toRotationMatrix();
  Measurement one = measured(turn, relaxed_arm(), 0.005);
  one.alternative = measured(Matrix::Identity(2, 2), relaxed_arm(), 0.005).identification;
  EXPECT_FALSE(check_symmetry(one));
  one.alternative->usable = false;
  EXPECT_TRUE(check_symmetry(one));
}

}  // namespace
}  // namespace mbk::analyse
