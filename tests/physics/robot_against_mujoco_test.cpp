#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "mbk/model/robot/dynamics.h"
#include "tests/physics/engine.h"

namespace mbk::robot {
namespace {

using physics::compiled;
using physics::EngineData;
using physics::EngineModel;

constexpr double kRightAngle = 0.5 * std::numbers::pi;

/// The robot as a serial arm of two links: hinges at base and elbow, absolute angles φ₁ = θ₁ and φ₂ = θ₂ − 90°. Its
/// centres of mass may lie anywhere, as long as
///   α₁ = I₁ + m₁c₁² + m₂d₁²,  α₃ = I₂ + m₂c₂²,  α₂ = 2 m₂d₁c₂.
std::string serial_arm(const PlanarRobot& robot, double time_step) {
  const double d1 = robot.geometry.d1, d2 = robot.geometry.d2;
  const double c1 = 0.4 * d1, c2 = 0.5 * d2, m1 = 0.8, m2 = robot.inertia.alpha2 / (2.0 * d1 * c2);
  const double I1 = robot.inertia.alpha1 - m1 * c1 * c1 - m2 * d1 * d1, I2 = robot.inertia.alpha3 - m2 * c2 * c2;
  const auto inertial = [](double centre, double mass, double inertia) {
    return fmt::format(R"(<inertial pos="{0:.17g} 0 0" mass="{1:.17g}" diaginertia="{2:.17g} {2:.17g} {2:.17g}"/>)",
                       centre, mass, inertia);
  };
  return fmt::format(R"(<mujoco><compiler angle="radian"/>
      <option gravity="0 0 0" timestep="{}" integrator="RK4"/>
      <worldbody><body name="first"><joint type="hinge" axis="0 0 1"/>{}
        <body name="last" pos="{:.17g} 0 0"><joint type="hinge" axis="0 0 1"/>{}
          <site name="hand" pos="{:.17g} 0 0"/></body></body></worldbody></mujoco>)",
                     time_step, inertial(c1, m1, I1), d1, inertial(c2, m2, I2), d2);
}

struct State {
  Vector2d theta, rate;
};

/// The engine, spoken to in the robot's angles. Its second angle is measured from the first link.
class Engine {
 public:
  Engine(const PlanarRobot& robot, double time_step)
      : model_(compiled(serial_arm(robot, time_step))), data_(mj_makeData(model_.get())) {}

  void set(const State& state) {
    data_->qpos[0] = state.theta[0];
    data_->qpos[1] = state.theta[1] - kRightAngle - state.theta[0];
    data_->qvel[0] = state.rate[0];
    data_->qvel[1] = state.rate[1] - state.rate[0];
  }

  [[nodiscard]] State state() const {
    return {{data_->qpos[0], data_->qpos[0] + data_->qpos[1] + kRightAngle},
            {data_->qvel[0], data_->qvel[0] + data_->qvel[1]}};
  }

  [[nodiscard]] Vector2d hand() {
    mj_forward(model_.get(), data_.get());
    return {data_->site_xpos[0], data_->site_xpos[1]};
  }

  /// θ̈ for torques on the absolute angles and a force at the hand, which the engine maps by a Jacobian of its own.
  Vector2d acceleration(const Vector2d& torque, const Vector2d& force) {
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());            // mj_applyFT needs both
    data_->qfrc_applied[0] = torque[0] + torque[1];  // the same power: θ̇₁ = q̇₁, θ̇₂ = q̇₁ + q̇₂
    data_->qfrc_applied[1] = torque[1];
    const mjtNum at_hand[3] = {force[0], force[1], 0.0}, no_torque[3] = {};
    const int last = mj_name2id(model_.get(), mjOBJ_BODY, "last");
    mj_applyFT(model_.get(), data_.get(), at_hand, no_torque, data_->site_xpos, last, data_->qfrc_applied);
    mj_forward(model_.get(), data_.get());
    return {data_->qacc[0], data_->qacc[0] + data_->qacc[1]};
  }

  void step() { mj_step(model_.get(), data_.get()); }

 private:
  EngineModel model_;
  EngineData data_;
};

/// One step of the classical Runge–Kutta method of order 4, nothing applied.
State stepped(const PlanarRobot& robot, const State& s, double T) {
  const auto slope = [&](const State& at) -> State {
    return {at.rate, robot.acceleration(at.theta, at.rate, Vector2d::Zero(), Vector2d::Zero())};
  };
  const auto along = [&](double t, const State& k) -> State { return {s.theta + t * k.theta, s.rate + t * k.rate}; };
  const State k1 = slope(s), k2 = slope(along(0.5 * T, k1)), k3 = slope(along(0.5 * T, k2)), k4 = slope(along(T, k3));
  return {s.theta + T / 6.0 * (k1.theta + 2.0 * k2.theta + 2.0 * k3.theta + k4.theta),
          s.rate + T / 6.0 * (k1.rate + 2.0 * k2.rate + 2.0 * k3.rate + k4.rate)};
}

TEST(RobotAgainstMujoco, PutsTheHandAtTheSamePlace) {
  const PlanarRobot robot;
  Engine engine(robot, 1e-3);
  constexpr double kRounding = 1e-15;  // [m]
  for (double theta1 = -0.9; theta1 < 1.5; theta1 += 0.3) {
    for (double theta2 = 0.1; theta2 < 2.5; theta2 += 0.3) {
      engine.set({{theta1, theta2}, Vector2d::Zero()});
      EXPECT_LE((engine.hand() - hand_position(robot.geometry, {theta1, theta2})).norm(), kRounding);
    }
  }
}

TEST(RobotAgainstMujoco, AcceleratesAlike) {
  const PlanarRobot robot;
  Engine engine(robot, 1e-3);
  std::mt19937_64 random(11);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11u) * 0x1p-53;
  };
  constexpr double kRelative = 1e-9;  // both solve the same 2×2 equation in other coordinates
  for (int i = 0; i < 2000; ++i) {
    const State s = {{uniform(-0.95, 1.57), uniform(0.0, 2.53)}, {uniform(-6.0, 6.0), uniform(-6.0, 6.0)}};
    const Vector2d torque(uniform(-3.0, 3.0), uniform(-3.0, 3.0)), force(uniform(-30.0, 30.0), uniform(-30.0, 30.0));
    engine.set(s);
    const Vector2d theirs = engine.acceleration(torque - robot.friction_torque(s.rate), force);
    const Vector2d ours = robot.acceleration(s.theta, s.rate, torque, force);
    ASSERT_LE((theirs - ours).norm(), kRelative * ours.norm())
        << "state " << i << ": theta " << s.theta.transpose() << ", rate " << s.rate.transpose();
  }
}

TEST(RobotAgainstMujoco, MovesAlikeForTenSecondsWithNothingApplied) {
  PlanarRobot robot;
  robot.friction = {};
  constexpr double kStep = 1e-3;  // [s]
  Engine engine(robot, kStep);
  State ours = {{0.4, 0.9}, {1.5, -2.0}};
  engine.set(ours);
  const double energy = robot.kinetic_energy(ours.theta, ours.rate);
  constexpr double kTolerance = 1e-9;  // [rad], [rad/s]: 10⁴ steps of the same method in other coordinates
  for (int i = 0; i < 10'000; ++i) {
    engine.step();
    ours = stepped(robot, ours, kStep);
    const State theirs = engine.state();
    ASSERT_LE((theirs.theta - ours.theta).norm(), kTolerance) << "step " << i;
    ASSERT_LE((theirs.rate - ours.rate).norm(), kTolerance) << "step " << i;
  }
  EXPECT_GT(std::abs(ours.theta[0] - 0.4), 1.0);  // it did move
  constexpr double kDrift = 1e-8;                 // of the method in 10 s
  EXPECT_NEAR(robot.kinetic_energy(ours.theta, ours.rate), energy, kDrift * energy);
}

}  // namespace
}  // namespace mbk::robot
