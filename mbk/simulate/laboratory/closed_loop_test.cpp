#include "mbk/simulate/laboratory/closed_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mbk/experiment/control/laws.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"
#include "mbk/simulate/participant/linear_limb.h"

namespace mbk::laboratory {
namespace {

const Vector2d kHome(0.30, -0.05);
constexpr double kTick = 1e-3;

participant::LinearLimb limb() {
  impedance::Model model = relaxed_arm();
  model.K << 42.4, -28.6, -28.6, 125.3;
  model.x0 = kHome + Vector2d(0.004, -0.003);
  return participant::LinearLimb::create(model).value();
}

/// Hand positions while the joints follow sines, and the last state.
struct Course {
  std::vector<Vector2d> path;
  TrueState last;
};

Course run(const ClosedLoop::Options& options, double duration, bool position_mode = true) {
  participant::LinearLimb load = limb();
  ClosedLoop loop = ClosedLoop::create(options, kHome, load).value();
  const Vector2d home = loop.motor_angle();
  auto control = control::JointPositionControl::create({}, kTick).value();
  const control::ForceControl force(options.robot.geometry);
  Course result;
  for (int i = 0; i * kTick < duration; ++i) {
    const double t = i * kTick;
    const Vector2d wave(std::sin(5.0 * t), std::sin(7.0 * t)),
        wave_rate(5.0 * std::cos(5.0 * t), 7.0 * std::cos(7.0 * t));
    const Vector2d torque = position_mode ? control.step(loop.motor_angle(), home + 0.03 * wave, 0.03 * wave_rate)
                                          : force.step(loop.motor_angle(), 3.0 * wave);
    result.last = loop.hold(torque, kTick);
    result.path.push_back(result.last.position);
    loop.advance();
  }
  return result;
}

double identity_error(const TrueState& state) {
  const EnergyLedger& e = state.energy;
  const double balance =
      e.motors - e.viscous - e.dry - e.cables - state.kinetic_energy - state.elastic_energy - e.absorbed;
  return std::abs(balance) / (std::abs(e.motors) + std::abs(e.absorbed) + e.viscous + e.dry);
}

TEST(ClosedLoop, EnergyAbsorbedIsWhatTheMotorsGaveLessLossesAndMotion) {
  for (const bool position_mode : {true, false}) {
    EXPECT_LT(identity_error(run({}, 20.0, position_mode).last), 1e-6) << position_mode;
  }
}

TEST(ClosedLoop, EnergyBalancesWithDryFrictionAndWithElasticCables) {
  ClosedLoop::Options dry;
  for (robot::JointFriction& joint : dry.robot.friction) {
    joint.coulomb = 0.1;
    joint.breakaway = 0.15;
  }
  EXPECT_LT(identity_error(run(dry, 20.0, false).last), 1e-3);
  ClosedLoop::Options elastic;
  elastic.capstan.emplace();
  EXPECT_LT(identity_error(run(elastic, 20.0).last), 1e-6);
}

TEST(ClosedLoop, HalvingTheStepLeavesThePathOfTheSmoothPlant) {
  ClosedLoop::Options finer;
  finer.steps_per_tick = 2;
  const Course coarse = run({}, 10.0), fine = run(finer, 10.0);
  double largest = 0.0, travel = 0.0;
  for (std::size_t i = 0; i < coarse.path.size(); ++i) {
    largest = std::max(largest, (coarse.path[i] - fine.path[i]).norm());
    travel = std::max(travel, (fine.path[i] - kHome).norm());
  }
  EXPECT_LT(largest, 1e-5 * travel);
}

TEST(ClosedLoop, ForceAtTheSensorObeysTheLimbAndTheHandle) {
  ClosedLoop::Options options;
  options.handle_mass = 0.194;
  const TrueState state = run(options, 1.234).last;
  const impedance::Model model = limb().impedance(kHome);
  const Vector2d expected = -(model.M * state.acceleration + 0.194 * state.acceleration + model.B * state.velocity +
                              model.K * (state.position - model.x0));
  EXPECT_LT((state.force_hand_on_robot - expected).norm(), 1e-12 * (1.0 + expected.norm()));
}

TEST(ClosedLoop, StiffCablesApproachTheRigidDrive) {
  double last = 1.0;
  for (const double stiffness : {300.0, 3000.0}) {
    ClosedLoop::Options elastic;
    elastic.capstan.emplace();
    elastic.capstan->stiffness.setConstant(stiffness);
    elastic.steps_per_tick = 8;
    const double gap = (run(elastic, 3.0).last.position - run({}, 3.0).last.position).norm();
    EXPECT_LT(gap, 0.3 * last);
    last = gap;
  }
}

TEST(ClosedLoop, RefusesWhatIsNoRobot) {
  participant::LinearLimb load = limb();
  ClosedLoop::Options options;
  EXPECT_FALSE(ClosedLoop::create(options, Vector2d(0.9, 0.0), load));
  options.robot.inertia.alpha2 = 0.2;
  EXPECT_FALSE(ClosedLoop::create(options, kHome, load));
  options = {};
  options.handle_mass = -0.1;
  EXPECT_EQ(ClosedLoop::create(options, kHome, load).error().message,
            "handle mass -0.1 kg is below zero or not finite");
}

}  // namespace
}  // namespace mbk::laboratory
