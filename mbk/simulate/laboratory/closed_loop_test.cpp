#include "mbk/simulate/laboratory/closed_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "mbk/experiment/control/laws.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"
#include "mbk/simulate/participant/linear_limb.h"
#include "mbk/simulate/participant/one_axis_joint.h"

namespace mbk::laboratory {
namespace closed_loop_test {

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
  TrueState<2> last;
};

Course run(const ClosedLoop<2>::Options& options, double duration, bool position_mode = true) {
  participant::LinearLimb load = limb();
  ClosedLoop<2> loop = ClosedLoop<2>::create(options, kHome, load).value();
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

template <int Axes>
double identity_error(const TrueState<Axes>& state) {
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
  ClosedLoop<2>::Options dry;
  for (robot::JointFriction& joint : dry.robot.friction) {
    joint.coulomb = 0.1;
    joint.breakaway = 0.15;
  }
  EXPECT_LT(identity_error(run(dry, 20.0, false).last), 1e-3);
  ClosedLoop<2>::Options elastic;
  elastic.capstan.emplace();
  EXPECT_LT(identity_error(run(elastic, 20.0).last), 1e-6);
  // Contacts that open and close within a step cost the integrator its order.
  elastic.capstan->backlash.setConstant(0.005);
  elastic.steps_per_tick = 8;
  EXPECT_LT(identity_error(run(elastic, 20.0).last), 1e-4);
}

TEST(ClosedLoop, HalvingTheStepLeavesThePathOfTheSmoothPlant) {
  ClosedLoop<2>::Options finer;
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
  ClosedLoop<2>::Options options;
  options.handle_mass = 0.194;
  const TrueState<2> state = run(options, 1.234).last;
  const impedance::Model model = limb().impedance(kHome);
  const Vector2d expected = -(model.M * state.acceleration + 0.194 * state.acceleration + model.B * state.velocity +
                              model.K * (state.position - model.x0));
  EXPECT_LT((state.force_hand_on_robot - expected).norm(), 1e-12 * (1.0 + expected.norm()));
}

TEST(ClosedLoop, StiffCablesApproachTheRigidDrive) {
  double last = 1.0;
  for (const double stiffness : {300.0, 3000.0}) {
    ClosedLoop<2>::Options elastic;
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
  ClosedLoop<2>::Options options;
  EXPECT_FALSE(ClosedLoop<2>::create(options, Vector2d(0.9, 0.0), load));
  options.robot.inertia.alpha2 = 0.2;
  EXPECT_FALSE(ClosedLoop<2>::create(options, kHome, load));
  options = {};
  options.handle_mass = -0.1;
  EXPECT_THAT(ClosedLoop<2>::create(options, kHome, load).error().message,
              AllOf(testing::HasSubstr("handle"), testing::HasSubstr("-0.1 kg")));
}

participant::OneAxisJoint joint(double viscosity = 0.8) {
  participant::OneAxisJoint::Options options;
  options.inertia = 0.015;
  options.viscosity = viscosity;
  options.stiffness = 45.0;
  options.remnant.floor = 0.0;
  return participant::OneAxisJoint::create(options, kTick).value();
}

ClosedLoop<1>::Options machine(double viscous, int steps = 1) {
  ClosedLoop<1>::Options options;
  options.robot.friction[0].viscous = viscous;
  options.steps_per_tick = steps;
  return options;
}

ClosedLoop<1> one_axis(const ClosedLoop<1>::Options& options, participant::Load<1>& load, double position = 0.0) {
  return ClosedLoop<1>::create(options, AxisVector<1>(position), load).value();
}

TEST(ClosedLoopOfOneAxis, SwingsAsTheClosedFormOfAnUndampedSpringAndInertia) {
  participant::OneAxisJoint load = joint(0.0);
  ClosedLoop<1> loop = one_axis(machine(0.0), load, 0.02);
  const double omega = std::sqrt(45.0 / (0.02 + 0.015));
  for (int i = 0; i < 2000; ++i) {
    ASSERT_NEAR(loop.motor_angle()[0], 0.02 * std::cos(omega * loop.time()), 0.02 * 1e-5) << loop.time();
    loop.hold(AxisVector<1>(0.0), kTick);
    loop.advance();
  }
}

TEST(ClosedLoopOfOneAxis, EnergyAbsorbedIsWhatTheMotorGaveLessLossesAndMotion) {
  participant::OneAxisJoint load = joint();
  ClosedLoop<1> loop = one_axis(machine(0.1), load);
  TrueState<1> last;
  for (int i = 0; i < 5000; ++i) {
    last = loop.hold(AxisVector<1>(2.0 * std::sin(9.0 * loop.time())), kTick);
    loop.advance();
  }
  EXPECT_DOUBLE_EQ(last.kinetic_energy, 0.5 * 0.02 * last.velocity.squaredNorm());
  EXPECT_LT(identity_error(last), 1e-6);
  EXPECT_GT(last.energy.absorbed, 0.1);
}

TEST(ClosedLoopOfOneAxis, HalvingTheStepChangesTheMotionByLessThanAHundredThousandth) {
  participant::OneAxisJoint load = joint(), again = joint();
  ClosedLoop<1> coarse = one_axis(machine(0.1), load), fine = one_axis(machine(0.1, 2), again);
  double away = 0.0, travel = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const AxisVector<1> motor(2.0 * std::sin(30.0 * coarse.time()));
    coarse.hold(motor, kTick);
    fine.hold(motor, kTick);
    coarse.advance();
    fine.advance();
    away = std::max(away, std::abs(coarse.motor_angle()[0] - fine.motor_angle()[0]));
    travel = std::max(travel, std::abs(fine.motor_angle()[0]));
  }
  EXPECT_LT(away, 1e-5 * travel);
}

TEST(ClosedLoopOfOneAxis, ReactionObeysTheJoint) {
  participant::OneAxisJoint load = joint();
  ClosedLoop<1> loop = one_axis(machine(0.1), load, 0.01);
  for (int i = 0; i < 500; ++i) {
    const TrueState<1>& state = loop.hold(AxisVector<1>(std::sin(20.0 * loop.time())), kTick);
    const double expected = -(0.015 * state.acceleration + 0.8 * state.velocity + 45.0 * state.position)[0];
    ASSERT_NEAR(state.force_hand_on_robot[0], expected, 1e-12);
    loop.advance();
  }
}

TEST(ClosedLoopOfOneAxis, TellsItsStateBeforeTheMotorChanges) {
  participant::OneAxisJoint load = joint();
  ClosedLoop<1> loop = one_axis(machine(0.1), load, 0.01);
  const TrueState<1> before = loop.state(), during = loop.hold(AxisVector<1>(3.0), kTick), after = loop.state();
  EXPECT_EQ(before.motor_torque[0], 0.0);
  EXPECT_EQ(after.motor_torque[0], 3.0);
  EXPECT_EQ(during.position, before.position);
  EXPECT_EQ(during.acceleration[0], 0.5 * (before.acceleration + after.acceleration)[0]);
  EXPECT_GT(after.acceleration[0], before.acceleration[0]);
}

TEST(ClosedLoopOfOneAxis, EnergyBalancesWithAnElasticCable) {
  participant::OneAxisJoint load = joint();
  ClosedLoop<1>::Options options = machine(0.1, 4);
  options.capstan.emplace().motor_inertia[0] = 0.005;
  ClosedLoop<1> loop = one_axis(options, load);
  TrueState<1> last;
  for (int i = 0; i < 5000; ++i) {
    last = loop.hold(AxisVector<1>(2.0 * std::sin(9.0 * loop.time())), kTick);
    loop.advance();
  }
  EXPECT_LT(identity_error(last), 1e-6);
  EXPECT_NE(last.motor_angle, last.theta);
  EXPECT_GT(last.energy.cables, 0.0);
}

TEST(ClosedLoopOfOneAxis, RefusesWhatIsNoMachine) {
  participant::OneAxisJoint load = joint();
  const AxisVector<1> home(0.0);
  ClosedLoop<1>::Options options;
  options.robot.inertia.mass = 0.0;
  EXPECT_THAT(ClosedLoop<1>::create(options, home, load).error().message, testing::HasSubstr("inertia"));
  EXPECT_FALSE(ClosedLoop<1>::create(machine(-0.1), home, load));
  EXPECT_FALSE(ClosedLoop<1>::create(machine(0.1, 0), home, load));
  const AxisVector<1> nowhere(std::numeric_limits<double>::infinity());
  EXPECT_THAT(ClosedLoop<1>::create(machine(0.1), nowhere, load).error().message, testing::HasSubstr("position"));
}

}  // namespace closed_loop_test
}  // namespace mbk::laboratory
