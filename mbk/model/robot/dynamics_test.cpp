#include "mbk/model/robot/dynamics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "mbk/model/robot/test_postures.h"

namespace mbk::robot {
namespace dynamics_test {

constexpr double kRounding = 1e-14;  // relative: some units in the last place of a double
const Geometry kGeometry;
const Inertia kInertia;

struct State {
  Vector2d theta, rate, torque, force;
};

/// Anywhere in the workspace, to 3 rad/s, 2 N·m and 20 N.
std::vector<State> random_states(int count) {
  std::mt19937_64 random(5);
  const auto uniform = [&](double reach) {
    return reach * (static_cast<double>(random() >> 11u) * 0x1p-52 - 1.0);  // in [−reach, reach)
  };
  const std::vector<Vector2d> places = postures(kGeometry.limits, 30);
  std::vector<State> states;
  for (int i = 0; i < count; ++i) {
    states.push_back({places[random() % places.size()],
                      {uniform(3.0), uniform(3.0)},
                      {uniform(2.0), uniform(2.0)},
                      {uniform(20.0), uniform(20.0)}});
  }
  return states;
}

TEST(Inertia, IsPositiveDefiniteAllOverTheWorkspace) {
  for (const Vector2d& theta : postures(kGeometry.limits, 30)) {
    const Matrix2d I = kInertia.matrix(theta);
    EXPECT_EQ(I, I.transpose());
    EXPECT_GT(I(0, 0), 0.0);
    EXPECT_GT(I(0, 0) * I(1, 1), I(0, 1) * I(0, 1));
  }
}

/// İ along θ̇, by its closed form.
Matrix2d inertia_rate(const State& state) {
  const double off =
      -0.5 * kInertia.alpha2 * std::cos(state.theta[0] - state.theta[1]) * (state.rate[0] - state.rate[1]);
  Matrix2d rate;
  rate << 0.0, off, off, 0.0;
  return rate;
}

TEST(Inertia, HasTheRateOfItsClosedForm) {
  constexpr double kStep = 1e-5, kTolerance = 1e-10;
  for (const State& s : random_states(50)) {
    const Matrix2d difference =
        (kInertia.matrix(s.theta + kStep * s.rate) - kInertia.matrix(s.theta - kStep * s.rate)) / (2.0 * kStep);
    EXPECT_LE((difference - inertia_rate(s)).norm(), kTolerance);
  }
}

TEST(Coriolis, MakesTheRateOfTheInertiaLessTwiceItselfSkew) {
  for (const State& s : random_states(200)) {
    const Matrix2d skew = inertia_rate(s) - 2.0 * kInertia.coriolis(s.theta, s.rate);
    EXPECT_LE((skew + skew.transpose()).norm(), kRounding);
  }
}

TEST(Coriolis, WithThePrintedSignTheLinksWouldGainWorkFromNowhere) {
  // (A.6) prints C₂₁ without its minus. The power of the links at rest from all torques, ½ θ̇ᵀ(İ − 2C)θ̇, must vanish.
  double largest = 0.0;
  for (const State& s : random_states(200)) {
    Matrix2d printed = kInertia.coriolis(s.theta, s.rate);
    printed(1, 0) = -printed(1, 0);
    largest = std::max(largest, std::abs(0.5 * s.rate.dot((inertia_rate(s) - 2.0 * printed) * s.rate)));
    EXPECT_LE(std::abs(0.5 * s.rate.dot((inertia_rate(s) - 2.0 * kInertia.coriolis(s.theta, s.rate)) * s.rate)),
              kRounding);
  }
  EXPECT_GT(largest, 0.1);  // [W], at up to 3 rad/s
}

TEST(Coriolis, IsWhatChristoffelsSymbolsGive) {
  // (Cθ̇)_i = Σ_jk (∂I_ij/∂θ_k − ½ ∂I_jk/∂θ_i) θ̇_j θ̇_k, with derivatives by central differences
  constexpr double kStep = 1e-5, kTolerance = 1e-9;
  for (const State& s : random_states(50)) {
    std::array<Matrix2d, 2> by_angle;
    for (int k = 0; k < 2; ++k) {
      const Vector2d step = kStep * Vector2d::Unit(k);
      by_angle[static_cast<std::size_t>(k)] =
          (kInertia.matrix(s.theta + step) - kInertia.matrix(s.theta - step)) / (2.0 * kStep);
    }
    Vector2d expected = (by_angle[0] * s.rate[0] + by_angle[1] * s.rate[1]) * s.rate;
    for (int i = 0; i < 2; ++i) expected[i] -= 0.5 * s.rate.dot(by_angle[static_cast<std::size_t>(i)] * s.rate);
    EXPECT_LE((kInertia.coriolis(s.theta, s.rate) * s.rate - expected).norm(), kTolerance);
  }
}

TEST(Payload, IsAPointMassAtTheHand) {
  // A mass m at the hand adds the torques Jᵀ m (J θ̈ + J̇ θ̇)
  constexpr double kMass = 1.3;  // [kg]
  const Inertia loaded = kInertia.with_payload(kGeometry, kMass);
  for (const State& s : random_states(200)) {
    const Matrix2d J = jacobian(kGeometry, s.theta);
    const Matrix2d matrix = kInertia.matrix(s.theta) + kMass * J.transpose() * J;
    EXPECT_LE((loaded.matrix(s.theta) - matrix).norm(), kRounding);
    const Vector2d coriolis = kInertia.coriolis(s.theta, s.rate) * s.rate +
                              kMass * J.transpose() * jacobian_rate(kGeometry, s.theta, s.rate) * s.rate;
    EXPECT_LE((loaded.coriolis(s.theta, s.rate) * s.rate - coriolis).norm(), 10.0 * kRounding);
  }
}

TEST(PlanarRobot, GainsTheWorkOfMotorsAndHandLessFriction) {
  PlanarRobot robot;
  robot.friction[0].coulomb = 0.1;
  for (const State& s : random_states(200)) {
    const Vector2d acceleration = robot.acceleration(s.theta, s.rate, s.torque, s.force);
    const double gain = s.rate.dot(robot.inertia.matrix(s.theta) * acceleration) +
                        0.5 * s.rate.dot(inertia_rate(s) * s.rate);  // d/dt(½ θ̇ᵀ I θ̇)
    const Vector2d hand_velocity = jacobian(robot.geometry, s.theta) * s.rate;
    const double power = s.rate.dot(s.torque - robot.friction_torque(s.rate)) + hand_velocity.dot(s.force);
    EXPECT_NEAR(gain, power, 100.0 * kRounding);
  }
}

TEST(PlanarRobot, TheKineticEnergyChangesByThatPower) {
  PlanarRobot robot;
  constexpr double kStep = 1e-5, kTolerance = 1e-6;  // [W]: kStep² times derivatives of a swift motion
  for (const State& s : random_states(50)) {
    const Vector2d a = robot.acceleration(s.theta, s.rate, s.torque, s.force);
    const auto energy = [&](double t) {
      return robot.kinetic_energy(s.theta + t * s.rate + 0.5 * t * t * a, s.rate + t * a);
    };
    const double power =
        s.rate.dot(s.torque + jacobian(robot.geometry, s.theta).transpose() * s.force - robot.friction_torque(s.rate));
    EXPECT_NEAR((energy(kStep) - energy(-kStep)) / (2.0 * kStep), power, kTolerance);
  }
}

TEST(PlanarRobot, MotorTorqueUndoesAcceleration) {
  const PlanarRobot robot;
  for (const State& s : random_states(200)) {
    const Vector2d acceleration = robot.acceleration(s.theta, s.rate, s.torque, s.force);
    const Vector2d torque = robot.motor_torque(s.theta, s.rate, acceleration, s.force);
    EXPECT_LE((torque - s.torque).norm(), 100.0 * kRounding);
  }
}

TEST(PlanarRobot, HasThePublishedConstants) {
  const PlanarRobot robot;  // table A.1
  EXPECT_EQ(robot.inertia.alpha1, 0.06929);
  EXPECT_EQ(robot.inertia.alpha2, 0.04217);
  EXPECT_EQ(robot.inertia.alpha3, 0.04416);
  EXPECT_TRUE(robot.friction_torque({1.0, 1.0}).isApprox(Vector2d(0.06510, 0.07389), kRounding));
}

TEST(InertiaAtHand, IsTheForceForAnAccelerationFromRest) {
  const PlanarRobot robot;
  for (const State& s : random_states(200)) {
    const auto at_hand = robot.inertia_at_hand(s.theta);
    ASSERT_TRUE(at_hand) << at_hand.error().line();
    const Vector2d joints = robot.acceleration(s.theta, Vector2d::Zero(), Vector2d::Zero(), s.force);
    const Vector2d back = *at_hand * (jacobian(robot.geometry, s.theta) * joints);
    EXPECT_LE((back - s.force).norm(), 1e-10 * s.force.norm());  // J is up to 10⁴ times smaller one way than the other
  }
}

TEST(InertiaAtHand, GrowsByAPayload) {
  PlanarRobot robot, loaded;
  loaded.inertia = robot.inertia.with_payload(robot.geometry, 0.5);
  const auto with = loaded.inertia_at_hand({0.3, 0.6}), without = robot.inertia_at_hand({0.3, 0.6});
  ASSERT_TRUE(with && without);
  EXPECT_LE((*with - *without - 0.5 * Matrix2d::Identity()).norm(), 1e-12);
}

TEST(InertiaAtHand, IsRefusedWhereTheLinksLieOnOneLine) {
  const PlanarRobot robot;
  const auto folded = robot.inertia_at_hand({0.5 * std::numbers::pi, 0.0});
  ASSERT_FALSE(folded);
  EXPECT_EQ(folded.error().kind, ErrorKind::usage);
  EXPECT_THAT(folded.error().message, testing::HasSubstr("90°"));
}

}  // namespace dynamics_test
}  // namespace mbk::robot
