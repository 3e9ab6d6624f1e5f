#include "mbk/model/robot/rigid_body.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <vector>

namespace mbk::robot {
namespace rigid_body_test {

constexpr double kRounding = 1e-14;

/// Points of mass, which know nothing of frames.
struct Cloud {
  std::vector<double> mass{0.4, 0.7, 0.2, 1.1, 0.5};
  std::vector<Eigen::Vector3d> place{
      {0.1, 0.0, 0.3}, {-0.2, 0.1, 0.0}, {0.05, -0.3, 0.2}, {0.0, 0.2, -0.1}, {0.3, 0.1, 0.1}};

  [[nodiscard]] Eigen::Matrix<double, kCoefficientsPerBody, 1> coefficients() const {
    Eigen::Matrix<double, kCoefficientsPerBody, 1> sum = Eigen::Matrix<double, kCoefficientsPerBody, 1>::Zero();
    for (std::size_t k = 0; k < mass.size(); ++k) {
      const double x = place[k].x(), y = place[k].y(), z = place[k].z();
      Eigen::Matrix<double, kCoefficientsPerBody, 1> one;
      one << 1.0, x, y, z, y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y;
      sum += mass[k] * one;
    }
    return sum;
  }
};

TEST(RigidBody, PseudoInertiaIsTheSecondMomentOfItsMass) {
  const Cloud cloud;
  Eigen::Matrix4d expected = Eigen::Matrix4d::Zero();
  for (std::size_t k = 0; k < cloud.mass.size(); ++k) {
    const Eigen::Vector4d r = cloud.place[k].homogeneous();
    expected += cloud.mass[k] * r * r.transpose();
  }
  EXPECT_LE((pseudo_inertia(cloud.coefficients()) - expected).cwiseAbs().maxCoeff(), kRounding);
}

TEST(RigidBody, ComesBackFromItsPseudoInertia) {
  const Eigen::Matrix4d J = pseudo_inertia(Cloud().coefficients());
  const RigidBody body = body_of(J);
  EXPECT_NEAR(body.mass, 2.9, kRounding);
  EXPECT_LE((pseudo_inertia(body) - J).cwiseAbs().maxCoeff(), kRounding);
}

TEST(RigidBody, IsNoneWhereAMomentOfInertiaExceedsTheSumOfTheOthers) {
  const auto smallest = [](double third) {
    const RigidBody body{2.0, {0.1, 0.2, 0.3}, Eigen::Vector3d(0.01, 0.02, third).asDiagonal()};
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(pseudo_inertia(body)).eigenvalues()[0];
  };
  EXPECT_GT(smallest(0.0299), 0.0);
  EXPECT_NEAR(smallest(0.03), 0.0, kRounding);  // a plate
  EXPECT_LT(smallest(0.0301), 0.0);
}

}  // namespace rigid_body_test
}  // namespace mbk::robot
