#include "mbk/model/robot/planar_mechanism.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "mbk/model/robot/test_models.h"
#include "mbk/model/robot/test_postures.h"

namespace mbk::robot {
namespace planar_mechanism_test {

constexpr double kRounding = 1e-14;  // of torques of some N·m
using Options = PlanarMechanism::Options;

struct State {
  Vector2d position, velocity, acceleration;
};

/// Anywhere in the workspace, to 3 rad/s and 20 rad/s².
std::vector<State> random_states(int count) {
  std::mt19937_64 random(11);
  const auto uniform = [&](double reach) { return reach * (static_cast<double>(random() >> 11u) * 0x1p-52 - 1.0); };
  const std::vector<Vector2d> places = postures(Geometry{}.limits, 30);
  std::vector<State> states;
  for (int i = 0; i < count; ++i) {
    states.push_back({places[random() % places.size()], {uniform(3.0), uniform(3.0)}, {uniform(20.0), uniform(20.0)}});
  }
  return states;
}

Matrix regressor(const PlanarMechanism& mechanism, const State& s) {
  Matrix Y(2, static_cast<Index>(mechanism.coefficients().size()));
  mechanism.regressor(s.position, s.velocity, s.acceleration, Y);
  return Y;
}

TEST(PlanarMechanism, RegressorTimesCoefficientsIsTheMotorTorqueOfTheRobot) {
  PlanarRobot robot;
  robot.friction = {};
  const PlanarMechanism mechanism({});
  for (const State& s : random_states(200)) {
    const Vector2d torque = robot.motor_torque(s.position, s.velocity, s.acceleration, Vector2d::Zero());
    EXPECT_LE((regressor(mechanism, s) * coefficients_of(robot.inertia) - torque).norm(), kRounding);
  }
}

TEST(PlanarMechanism, RegressorsOfAMotionAreThoseOfItsSamples) {
  for (const std::optional<double> up : {std::optional<double>(), std::optional<double>(1.2)}) {
    const PlanarMechanism mechanism({{}, up, {}});
    const JointMotion motion = Swing{}.sampled(50, 0.01);
    const std::vector<Matrix> at_once = mechanism.regressors(motion),
                              one_by_one = mechanism.Mechanism::regressors(motion);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      EXPECT_LE((at_once[joint] - one_by_one[joint]).cwiseAbs().maxCoeff(), 100.0 * kRounding);
    }
  }
}

TEST(PlanarMechanism, TermsAreThoseOfDifferencesOfTheRegressor) {
  const PlanarMechanism mechanism({{}, 0.5, {}});
  Vector phi(5);
  phi << coefficients_of(Inertia{}), 0.8, 0.3;
  for (const State& s : random_states(100)) {
    const JointTerms own = mechanism.terms(s.position, s.velocity, phi);
    const JointTerms by_differences = mechanism.Mechanism::terms(s.position, s.velocity, phi);
    EXPECT_LE((own.inertia - by_differences.inertia).norm(), kRounding);
    EXPECT_LE((own.gravity - by_differences.gravity).norm(), kRounding);
    // kinetic energies of about 1 J over steps of 1e-5 rad
    EXPECT_LE((own.coriolis_transposed - by_differences.coriolis_transposed).norm(), 1e-9);
  }
}

TEST(PlanarMechanism, TermsPutTheTorqueTogetherAgain) {
  // I q̈ + İ q̇ − Cᵀq̇ + g, with İ q̇ by differences along the motion
  const PlanarMechanism mechanism({{}, 0.5, {}});
  Vector phi(5);
  phi << coefficients_of(Inertia{}), 0.8, 0.3;
  constexpr double kStep = 1e-5, kTolerance = 1e-8;
  for (const State& s : random_states(100)) {
    const auto inertia = [&](double t) {
      return mechanism.terms(Vector2d(s.position + t * s.velocity), s.velocity, phi).inertia;
    };
    const JointTerms now = mechanism.terms(s.position, s.velocity, phi);
    const Vector torque = now.inertia * s.acceleration +
                          (inertia(kStep) - inertia(-kStep)) / (2.0 * kStep) * s.velocity - now.coriolis_transposed +
                          now.gravity;
    EXPECT_LE((regressor(mechanism, s) * phi - torque).norm(), kTolerance);
  }
}

TEST(PlanarMechanism, GravityIsTheSlopeOfThePotentialEnergy) {
  constexpr double kUp = 2.0, kStep = 1e-6;
  const PlanarMechanism mechanism({{}, kUp, {}});
  EXPECT_EQ(mechanism.coefficients().size(), 5U);
  Vector phi = Vector::Zero(5);
  phi.tail(2) << 0.8, 0.3;
  const auto energy = [&](const Vector2d& q) { return 0.8 * std::cos(q[0] - kUp) + 0.3 * std::sin(q[1] - kUp); };
  for (const State& s : random_states(50)) {
    const State still{s.position, Vector2d::Zero(), Vector2d::Zero()};
    for (Index joint = 0; joint < 2; ++joint) {
      const Vector2d step = kStep * Vector2d::Unit(joint);
      const double slope = (energy(s.position + step) - energy(s.position - step)) / (2.0 * kStep);
      EXPECT_NEAR((regressor(mechanism, still) * phi)[joint], slope, 1e-9);
    }
  }
}

TEST(PlanarMechanism, HeightOfThePayloadIsWhatItsGravityCoefficientsSay) {
  // m g p·up = γ₁ cos(θ₁ − φ_u) + γ₂ sin(θ₂ − φ_u) for γ = m g [d₁, d₂]
  constexpr double kUp = 0.7, kWeight = 5.0;
  const PlanarMechanism mechanism({{}, kUp, {}});
  const Geometry geometry;
  Vector phi = Vector::Zero(5);
  phi.tail(2) << kWeight * geometry.d1, kWeight * geometry.d2;
  for (const State& s : random_states(50)) {
    const State still{s.position, Vector2d::Zero(), Vector2d::Zero()};
    const Vector2d force(kWeight * std::cos(kUp), kWeight * std::sin(kUp));  // that holds the payload
    EXPECT_LE((regressor(mechanism, still) * phi - jacobian(geometry, s.position).transpose() * force).norm(),
              10.0 * kRounding);
  }
}

TEST(PlanarMechanism, PayloadAtTheHandAddsToTheThreeCoefficients) {
  // m at the hand adds m [d₁², 2 d₁d₂, d₂²] to α, and so the torques Jᵀ m (J q̈ + J̇ q̇)
  constexpr double kMass = 0.8;  // [kg]
  const Geometry geometry;
  const PlanarMechanism mechanism({});
  const Eigen::Vector3d added =
      kMass * Eigen::Vector3d(geometry.d1 * geometry.d1, 2.0 * geometry.d1 * geometry.d2, geometry.d2 * geometry.d2);
  for (const State& s : random_states(200)) {
    const Vector2d of_hand =
        mechanism.jacobian(s.position) * s.acceleration + mechanism.jacobian_rate(s.position, s.velocity) * s.velocity;
    const Vector2d torque = kMass * mechanism.jacobian(s.position).transpose() * of_hand;
    EXPECT_LE((regressor(mechanism, s) * added - torque).norm(), 10.0 * kRounding);
  }
}

/// q̇ᵀ τ − d/dt(½ q̇ᵀ I q̇): the power that goes nowhere, with İ by its closed form.
double lost_power(const PlanarMechanism& mechanism, const State& s) {
  const Inertia inertia;
  const Vector2d torque = regressor(mechanism, s) * coefficients_of(inertia);
  const double off = -0.5 * inertia.alpha2 * std::cos(s.position[0] - s.position[1]) * (s.velocity[0] - s.velocity[1]);
  Matrix2d rate;
  rate << 0.0, off, off, 0.0;
  return s.velocity.dot(torque) - s.velocity.dot(inertia.matrix(s.position) * s.acceleration) -
         0.5 * s.velocity.dot(rate * s.velocity);
}

TEST(PlanarMechanism, KeepsEnergyAndWithThePrintedCoriolisSignDoesNot) {
  const PlanarMechanism skew({}), printed({{}, {}, PlanarMechanism::Coriolis::printed});
  double largest = 0.0;
  for (const State& s : random_states(200)) {
    EXPECT_NEAR(lost_power(skew, s), 0.0, 100.0 * kRounding);
    largest = std::max(largest, std::abs(lost_power(printed, s)));
  }
  EXPECT_GT(largest, 0.1);  // [W], at up to 3 rad/s
}

TEST(PlanarMechanism, HandIsWhereTheKinematicsPutIt) {
  const Geometry geometry{.d1 = 0.31, .d2 = 0.2};
  const PlanarMechanism mechanism({geometry, {}, {}});
  for (const State& s : random_states(20)) {
    EXPECT_EQ(Vector2d(mechanism.hand_position(s.position)), hand_position(geometry, s.position));
    EXPECT_EQ(Matrix2d(mechanism.jacobian(s.position)), jacobian(geometry, s.position));
    EXPECT_EQ(Matrix2d(mechanism.jacobian_rate(s.position, s.velocity)),
              jacobian_rate(geometry, s.position, s.velocity));
  }
}

TEST(PlanarMechanism, PosturesAreWithinTheLimitsAndReachTheirCorners) {
  const PlanarMechanism mechanism({});
  const std::vector<JointVector> grid = mechanism.postures(9);
  ASSERT_GT(grid.size(), 20U);
  double highest = -1e9;
  for (const JointVector& one : grid) {
    EXPECT_TRUE(mechanism.check_joints(one)) << one.transpose();
    highest = std::max(highest, one[1]);
  }
  EXPECT_DOUBLE_EQ(highest, Geometry{}.limits.theta2_high);
}

TEST(PlanarMechanism, RefusesJointsBeyondTheirLimitsAndThoseThatAreNoNumbers) {
  const PlanarMechanism mechanism({});
  const auto beyond = mechanism.check_joints(Vector2d(0.3, 3.0));
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().message, testing::HasSubstr("θ₂"));
  EXPECT_FALSE(mechanism.check_joints(Vector2d(std::numeric_limits<double>::quiet_NaN(), 0.5)));
}

}  // namespace planar_mechanism_test
}  // namespace mbk::robot
