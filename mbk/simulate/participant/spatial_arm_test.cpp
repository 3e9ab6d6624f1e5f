#include "mbk/simulate/participant/spatial_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/dense.h"

namespace mbk::participant {
namespace spatial_arm_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Hand = perturbation::Jet<perturbation::AxesVector>;

constexpr double kDegree = std::numbers::pi / 180.0;
const Vector3d kHome(0.3, 0.4, -0.2), kAtRest = Vector3d::Zero();

/// Its hand is held away from its equilibrium, so that a force turns with the joints, and nothing is symmetric.
SpatialArm displaced() {
  SpatialArm::Options options;
  options.equilibrium = kHome + Vector3d(0.04, -0.03, 0.05);
  options.stiffness(0, 2) += 1.5;
  return SpatialArm::create(options, kHome).value();
}

/// −∂F/∂ of one argument, by central differences.
template <class Force>
Matrix3d slope(const Force& force, double step) {
  Matrix3d slope;
  for (Index i = 0; i < 3; ++i) {
    const Vector3d change = step * Vector3d::Unit(i);
    slope.col(i) = -(force(change) - force(-change)) / (2.0 * step);
  }
  return slope;
}

TEST(SpatialArm, JointAnglesAreThoseOfThePosture) {
  for (const double plane : {-20.0, 30.0, 75.0, 110.0, 179.0}) {
    for (const double elevation : {20.0, 45.0, 80.0}) {
      for (const double elbow : {40.0, 85.0, 120.0}) {
        SpatialArm::Options options;
        options.posture = kDegree * Vector3d(plane, elevation, elbow);
        options.axial_rotation = 30.0 * kDegree;
        const auto arm = SpatialArm::create(options, kHome);
        ASSERT_TRUE(arm) << plane << ' ' << elevation << ' ' << elbow << ": " << arm.error().message;
        const Vector3d place = kHome + Vector3d(0.02, -0.01, 0.015);
        EXPECT_NEAR((arm->hand_position(arm->joint_angles(place)) - place).norm(), 0.0, 1e-12);
      }
    }
  }
}

TEST(SpatialArm, AnglesTurnAsStated) {
  SpatialArm::Options options;
  options.axial_rotation = 90.0 * kDegree;
  const SpatialArm arm = SpatialArm::create(options, kHome).value();
  const double l1 = options.upper_arm, l2 = options.forearm;
  const Vector3d shoulder = arm.hand_position(Vector3d::Zero()) + Vector3d(0.0, 0.0, l1 + l2);
  const auto from_shoulder = [&](double plane, double elevation, double elbow) -> Vector3d {
    return arm.hand_position(kDegree * Vector3d(plane, elevation, elbow)) - shoulder;
  };
  const double rounding = 1e-12;
  EXPECT_NEAR((from_shoulder(0, 90, 0) - Vector3d(l1 + l2, 0, 0)).norm(), 0.0, rounding);   // to the side
  EXPECT_NEAR((from_shoulder(90, 90, 0) - Vector3d(0, l1 + l2, 0)).norm(), 0.0, rounding);  // to the front
  EXPECT_NEAR((from_shoulder(90, 90, 90) - Vector3d(-l2, l1, 0)).norm(), 0.0, rounding);    // towards the middle
}

TEST(SpatialArm, InertiaAboutTheVerticalIsThatOfItsSegments) {
  // The upper arm to the front and level, the forearm level and at a right angle to it
  SpatialArm::Options options;
  options.posture = kDegree * Vector3d(90.0, 90.0, 90.0);
  options.axial_rotation = 90.0 * kDegree;
  const SpatialArm arm = SpatialArm::create(options, kHome).value();
  const double l1 = options.upper_arm, grip = options.forearm, mass = options.body_mass;
  const double forearm = grip * 0.2689 / (0.2689 + 0.79 * 0.0862), hand = grip * 0.0862 / (0.2689 + 0.79 * 0.0862);
  const auto about = [&](double share, double distance_squared, double radius) {
    return share * mass * (distance_squared + radius * radius);
  };
  const double expected = about(0.0271, std::pow(0.5772 * l1, 2), 0.277 * l1) +
                          about(0.0162, l1 * l1 + std::pow(0.4574 * forearm, 2), 0.2705 * forearm) +
                          about(0.0061, l1 * l1 + grip * grip, 0.5705 * hand);
  // The hand is at (−grip, l1, 0) from the shoulder; q₁ alone moves it along z × that
  const Vector3d velocity(-l1, -grip, 0.0);
  const Matrix3d M = arm.impedance(kHome).M;
  EXPECT_NEAR(velocity.dot(M * velocity), expected, 1e-12);
}

TEST(SpatialArm, ItsImpedanceIsTheSlopeOfItsForce) {
  const SpatialArm arm = displaced();
  const impedance::Model model = arm.impedance(kHome);
  const auto place = [&](const Vector3d& d) { return arm.force(Hand{kHome + d, kAtRest, kAtRest}); };
  const auto velocity = [&](const Vector3d& d) { return arm.force(Hand{kHome, d, kAtRest}); };
  const auto acceleration = [&](const Vector3d& d) { return arm.force(Hand{kHome, kAtRest, d}); };
  // Second-order differences of a force that varies over some 0.1 m: (1e-5/0.1)² of 100 N/m; the rest is rounding
  EXPECT_LT((slope(place, 1e-5) - model.K).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_LT((slope(velocity, 1e-2) - model.B).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((slope(acceleration, 1.0) - model.M).cwiseAbs().maxCoeff(), 1e-10);
  const Vector3d force = place(kAtRest), by_truth = -model.K * (kHome - model.x0);
  EXPECT_GT(force.norm(), 1.0);
  EXPECT_NEAR((force - by_truth).norm(), 0.0, 1e-10);
}

TEST(SpatialArm, AForceStiffensThroughTheGeometry) {
  SpatialArm::Options options;
  options.equilibrium = kHome + Vector3d(0.04, -0.03, 0.05);
  const Matrix3d here = SpatialArm::create({}, kHome).value().impedance(kHome).K;
  const Matrix3d away = SpatialArm::create(options, kHome).value().impedance(kHome).K;
  EXPECT_GT((away - here).norm(), 0.01 * here.norm());
  EXPECT_NEAR((away - away.transpose()).norm(), 0.0, 1e-10);  // the force has a potential
}

TEST(SpatialArm, ItsInertiaObeysLagrange) {
  // Without springs and dampers −F = d/dt (M v) − ½ ∂(vᵀ M v)/∂x, with M from the impedance alone
  SpatialArm::Options options;
  options.damping.setZero();
  options.stiffness.setZero();
  const SpatialArm arm = SpatialArm::create(options, kHome).value();
  const Vector3d v(0.6, -0.4, 0.8), a(2.0, 4.0, -3.0);
  const auto inertia = [&](const Vector3d& place) -> Matrix3d { return arm.impedance(place).M; };
  const double step = 1e-5;
  const auto momentum = [&](double t) -> Vector3d { return inertia(kHome + v * t + 0.5 * a * t * t) * (v + a * t); };
  Vector3d expected = -(momentum(step) - momentum(-step)) / (2.0 * step);
  for (Index i = 0; i < 3; ++i) {
    const Vector3d d = step * Vector3d::Unit(i);
    expected[i] += 0.5 * v.dot((inertia(kHome + d) - inertia(kHome - d)) * v) / (2.0 * step);
  }
  const Vector3d found = arm.force(Hand{kHome, v, a});
  const Vector3d linear = -inertia(kHome) * a;
  EXPECT_GT((found - linear).norm(), 0.1);  // centrifugal and Coriolis forces are there
  EXPECT_NEAR((found - expected).norm(), 0.0, 1e-6);
}

TEST(SpatialArm, MatricesOfTheDefaultArePositive) {
  const impedance::Model model = SpatialArm::create({}, kHome).value().impedance(kHome);
  for (const Matrix* matrix : {&model.M, &model.B, &model.K}) {
    EXPECT_NEAR((*matrix - matrix->transpose()).norm(), 0.0, 1e-10);
    EXPECT_GT(numeric::symmetric_eigenvalues(*matrix)[0], 0.0);
  }
  EXPECT_NEAR((model.x0 - kHome).norm(), 0.0, 1e-10);
}

TEST(SpatialArm, RefusesPosturesThatTheHandDoesNotDetermine) {
  const auto refused = [](const Vector3d& posture) {
    SpatialArm::Options options;
    options.posture = kDegree * posture;
    return !SpatialArm::create(options, kHome);
  };
  EXPECT_TRUE(refused({75.0, 45.0, 0.0}));    // straight
  EXPECT_TRUE(refused({75.0, 45.0, -60.0}));  // bent backwards
  EXPECT_FALSE(refused({75.0, 45.0, 85.0}));
}

TEST(SpatialArm, RefusesWhatCannotBe) {
  SpatialArm::Options options;
  options.body_mass = 0.0;
  EXPECT_FALSE(SpatialArm::create(options, kHome));
  options = {};
  options.equilibrium = kHome + Vector3d(1.0, 0.0, 0.0);
  EXPECT_FALSE(SpatialArm::create(options, kHome));
  options = {};
  options.stiffness(1, 1) = NAN;
  EXPECT_FALSE(SpatialArm::create(options, kHome));
}

TEST(SpatialArm, OutOfReachItsForceIsNotFinite) {
  const SpatialArm arm = SpatialArm::create({}, kHome).value();
  EXPECT_FALSE(arm.force(Hand{kHome + Vector3d(0.0, 1.0, 0.0), kAtRest, kAtRest}).allFinite());
}

}  // namespace spatial_arm_test
}  // namespace mbk::participant
