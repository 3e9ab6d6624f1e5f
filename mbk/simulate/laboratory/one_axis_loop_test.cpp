#include "mbk/simulate/laboratory/one_axis_loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/simulate/participant/one_axis_joint.h"

namespace mbk::laboratory {
namespace {

constexpr double kTick = 1e-3;

participant::OneAxisJoint joint(double viscosity = 0.8) {
  participant::OneAxisJoint::Options options;
  options.inertia = 0.015;
  options.viscosity = viscosity;
  options.stiffness = 45.0;
  options.remnant.floor = 0.0;
  return participant::OneAxisJoint::create(options, kTick).value();
}

OneAxisLoop::Machine machine(double viscous, int steps = 1) {
  OneAxisLoop::Machine m;
  m.friction.viscous = viscous;
  m.steps_per_tick = steps;
  return m;
}

TEST(OneAxisLoop, SwingsAsTheClosedFormOfAnUndampedSpringAndInertia) {
  participant::OneAxisJoint load = joint(0.0);
  OneAxisLoop loop = OneAxisLoop::create(machine(0.0), 0.02, load, 0.0).value();
  const double omega = std::sqrt(45.0 / (0.02 + 0.015));
  for (int i = 0; i < 2000; ++i) {
    ASSERT_NEAR(loop.position(), 0.02 * std::cos(omega * loop.time()), 0.02 * 1e-5) << loop.time();
    loop.hold(0.0, kTick);
    loop.advance();
  }
}

TEST(OneAxisLoop, EnergyAbsorbedIsWhatTheMotorGaveLessLossesAndMotion) {
  participant::OneAxisJoint load = joint();
  OneAxisLoop loop = OneAxisLoop::create(machine(0.1), 0.0, load, 0.0).value();
  OneAxisTrueState last;
  for (int i = 0; i < 5000; ++i) {
    last = loop.hold(2.0 * std::sin(9.0 * loop.time()), kTick);
    loop.advance();
  }
  const double kinetic = 0.5 * 0.02 * last.velocity * last.velocity;
  EXPECT_NEAR(last.absorbed, last.work_motor - last.lost - kinetic, 1e-6 * last.work_motor);
  EXPECT_GT(last.absorbed, 0.1);
}

TEST(OneAxisLoop, HalvingTheStepChangesTheMotionByLessThanAHundredThousandth) {
  participant::OneAxisJoint load = joint(), again = joint();
  OneAxisLoop coarse = OneAxisLoop::create(machine(0.1), 0.0, load, 0.0).value();
  OneAxisLoop fine = OneAxisLoop::create(machine(0.1, 2), 0.0, again, 0.0).value();
  double away = 0.0, travel = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double motor = 2.0 * std::sin(30.0 * coarse.time());
    coarse.hold(motor, kTick);
    fine.hold(motor, kTick);
    coarse.advance();
    fine.advance();
    away = std::max(away, std::abs(coarse.position() - fine.position()));
    travel = std::max(travel, std::abs(fine.position()));
  }
  EXPECT_LT(away, 1e-5 * travel);
}

TEST(OneAxisLoop, ReactionObeysTheJoint) {
  participant::OneAxisJoint load = joint();
  OneAxisLoop loop = OneAxisLoop::create(machine(0.1), 0.01, load, 0.0).value();
  for (int i = 0; i < 500; ++i) {
    const OneAxisTrueState& state = loop.hold(std::sin(20.0 * loop.time()), kTick);
    const double expected = -(0.015 * state.acceleration + 0.8 * state.velocity + 45.0 * state.position);
    ASSERT_NEAR(state.reaction, expected, 1e-12);
    loop.advance();
  }
}

TEST(OneAxisLoop, RefusesWhatIsNoMachine) {
  participant::OneAxisJoint load = joint();
  OneAxisLoop::Machine m;
  m.inertia = 0.0;
  EXPECT_EQ(OneAxisLoop::create(m, 0.0, load, 0.0).error().message, "inertia 0 of the machine is not above zero");
  EXPECT_FALSE(OneAxisLoop::create(machine(-0.1), 0.0, load, 0.0));
  EXPECT_FALSE(OneAxisLoop::create(machine(0.1, 0), 0.0, load, 0.0));
}

}  // namespace
}  // namespace mbk::laboratory
