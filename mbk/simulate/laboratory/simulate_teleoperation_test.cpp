#include "mbk/simulate/laboratory/simulate_teleoperation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/dense.h"
#include "mbk/simulate/laboratory/axis_loads.h"
#include "mbk/teleop/worst_terminations.h"

namespace mbk::laboratory {
namespace {

using teleop::Architecture;
using teleop::Rational;
using teleop::Teleoperator;

Teleoperator position_position(const Rational& k_s = 200) {
  Teleoperator t;
  t.values = {{"master.m", {1, 2}}, {"master.b", 1}, {"master.d", 10}, {"master.k", 100},
              {"slave.m", {4, 5}},  {"slave.b", 1},  {"slave.d", 20},  {"slave.k", k_s}};
  return t;
}

TeleoperationSetup setup(Teleoperator teleoperator = position_position()) {
  TeleoperationSetup result;
  result.teleoperator = std::move(teleoperator);
  result.duration = 4.0;
  return result;
}

TeleoperationMotion moved(const TeleoperationSetup& setup, const Termination& hand, const Termination& environment) {
  MassSpringDamper at_master(hand.mass, hand.damping, hand.stiffness),
      at_slave(environment.mass, environment.damping, environment.stiffness);
  auto motion = simulate(setup, at_master, at_slave);
  EXPECT_TRUE(motion) << motion.error().line();
  return *motion;
}

/// What a fast controller comes to: the linear system from the velocity that the kick gives, e^(A t) x(0).
Eigen::Vector4d closed_form(double t, double kick) {
  const double m_m = 0.5 + 0.3, m_s = 0.8 + 0.2;  // with what is held
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();    // of x_m, x_s, v_m, v_s
  A(0, 2) = A(1, 3) = 1.0;
  A.row(2) << -(100.0 + 40.0) / m_m, 100.0 / m_m, -(1.0 + 10.0 + 2.0) / m_m, 10.0 / m_m;
  A.row(3) << 200.0 / m_s, -(200.0 + 70.0) / m_s, 20.0 / m_s, -(1.0 + 20.0 + 3.0) / m_s;
  return numeric::matrix_exponential(A * t) * Eigen::Vector4d(0.0, 0.0, kick / m_m, 0.0);
}

TEST(SimulateTeleoperation, ComesToTheClosedFormAsTheControllerGetsFaster) {
  const Termination hand{0.3, 2.0, 40.0}, environment{0.2, 3.0, 70.0};
  double last = 0.0;
  for (const double tick : {1e-3, 2.5e-4}) {
    TeleoperationSetup fast = setup();
    fast.sample_time = tick;
    const TeleoperationMotion motion = moved(fast, hand, environment);
    double away = 0.0, travel = 0.0;
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
      const Eigen::Vector4d exact = closed_form(motion.time[i], fast.kick);
      away = std::max(away, std::hypot(motion.master_position[i] - exact[0], motion.slave_position[i] - exact[1]));
      travel = std::max(travel, std::abs(exact[0]));
    }
    EXPECT_LT(away, 20.0 * tick * travel);  // half a tick of delay at 11 rad/s, and of the kick
    if (last > 0.0) {
      EXPECT_NEAR(away, 0.25 * last, 0.05 * last);  // first order in the tick
    }
    last = away;
  }
}

TEST(SimulateTeleoperation, FollowsThroughADelayOfWholeTicks) {
  // a slave with nothing but its own controller hears of the kick only when the delay is over
  Teleoperator delayed = position_position();
  delayed.values["delay.to_slave"] = {1, 50};
  const TeleoperationMotion motion = moved(setup(delayed), {}, {});
  for (std::size_t i = 0; i < motion.time.size() && motion.time[i] <= 0.0205; ++i) {
    EXPECT_EQ(motion.slave_position[i], 0.0) << motion.time[i];
  }
  EXPECT_GT(motion.slave_position[40], 0.0);
}

TEST(SimulateTeleoperation, LosesAllPacketsAndStaysAlone) {
  TeleoperationSetup deaf = setup();
  deaf.line.loss = 1.0;
  const TeleoperationMotion motion = moved(deaf, {}, {});
  EXPECT_EQ(motion.lost, motion.sent);
  for (const double x : motion.slave_position) EXPECT_EQ(x, 0.0);
}

TEST(SimulateTeleoperation, GrowsAsPredictedAgainstTheWorstTerminations) {
  for (const int k_s : {50, 1000}) {  // outside of 92.75 … 431.25
    const TeleoperationSetup wrong = setup(position_position(k_s));
    std::vector<RadPerSec> omega;
    for (int i = 0; i < 200; ++i) omega.emplace_back(0.5 * std::pow(200.0, i / 199.0));
    const auto worst = teleop::worst_terminations(wrong.teleoperator, omega, wrong.sample_time);
    ASSERT_TRUE(worst) << k_s;
    for (const Termination& one : worst->at_port) {
      EXPECT_GE(one.mass, 0.0);
      EXPECT_GE(one.stiffness, 0.0);
      EXPECT_EQ(one.damping, 0.0);
    }
    TeleoperationSetup longer = wrong;
    longer.duration = duration_to_show(*worst);
    const MotionVerdict verdict = judge(moved(longer, worst->at_port[0], worst->at_port[1]));
    EXPECT_NEAR(verdict.frequency.value, worst->frequency.value, 0.02 * worst->frequency.value);
    EXPECT_NEAR(verdict.growth, worst->growth, 0.1 * worst->growth);
  }
}

TEST(SimulateTeleoperation, IsHeldByAPassivityControllerAtTheMaster) {
  Teleoperator reflecting = position_position();
  reflecting.architecture = Architecture::position_force;
  reflecting.values["channels.force_to_master"] = {9, 10};
  reflecting.values["master.d"] = reflecting.values["master.k"] = 0;
  std::vector<RadPerSec> omega;
  for (int i = 0; i < 100; ++i) omega.emplace_back(20.0 * std::pow(20.0, i / 99.0));
  TeleoperationSetup free = setup(reflecting);
  const auto worst = teleop::worst_terminations(free.teleoperator, omega, free.sample_time);
  ASSERT_TRUE(worst);
  free.duration = duration_to_show(*worst);
  EXPECT_EQ(judge(moved(free, worst->at_port[0], worst->at_port[1])).outcome, MotionOutcome::grows);
  TeleoperationSetup held = free;
  held.passivity_controller = 0.5 * 0.5 / 1e-3;  // half of what its mass bears in a tick
  const TeleoperationMotion motion = moved(held, worst->at_port[0], worst->at_port[1]);
  EXPECT_NE(judge(motion).outcome, MotionOutcome::grows);
  EXPECT_LT(*motion.lowest_energy, 0.0);
}

TEST(WorstTerminations, AreNoneForAStableDesign) {
  std::vector<RadPerSec> omega;
  for (int i = 0; i < 200; ++i) omega.emplace_back(0.1 * std::pow(1e4, i / 199.0));
  EXPECT_FALSE(teleop::worst_terminations(position_position(), omega, 0.0));
  EXPECT_FALSE(teleop::worst_terminations(position_position(), {}, 0.0));
}

TEST(WorstTerminations, LeaveAnOperatorWithAnExcessItsDamping) {
  const Teleoperator wrong = position_position(1500);
  std::vector<RadPerSec> omega;
  for (int i = 0; i < 200; ++i) omega.emplace_back(0.5 * std::pow(200.0, i / 199.0));
  const auto worst = teleop::worst_terminations(wrong, omega, 0.0, teleop::Port::one, -0.5);
  ASSERT_TRUE(worst);
  EXPECT_EQ(worst->at_port[0].damping, 0.5);
  EXPECT_EQ(worst->at_port[1].damping, 0.0);
}

TEST(Teleoperator, WithSamplingLosesTheDampingOfHalfATick) {
  // r₁₁ at low frequencies: b + d − k T/2, the limit of a sampled spring (Colgate & Schenkel 1997)
  const double T = 1e-3, expected = 1.0 + 10.0 - 100.0 * T / 2.0;
  const Eigen::Matrix2cd z =
      teleop::immittance(position_position().with_exact_delay(RadPerSec(1e-3), T), teleop::Form::z);
  EXPECT_NEAR(z(0, 0).real(), expected, 1e-5);  // the damper is late too, which is of second order
}

TEST(JudgeMotion, TellsWhatGrowsFromWhatDiesOut) {
  for (const auto& [rate, outcome] :
       {std::pair{0.5, MotionOutcome::grows}, {0.0, MotionOutcome::bounded}, {-0.5, MotionOutcome::dies_out}}) {
    TeleoperationMotion motion;
    for (int i = 0; i < 10000; ++i) {
      const double t = 1e-3 * i;
      motion.time.push_back(t);
      motion.master_velocity.push_back(std::exp(rate * t) * std::sin(12.0 * t));
      motion.slave_velocity.push_back(0.0);
    }
    const MotionVerdict verdict = judge(motion);
    EXPECT_EQ(verdict.outcome, outcome) << rate;
    EXPECT_NEAR(verdict.frequency.value, 12.0, 0.05);
    EXPECT_NEAR(verdict.growth, rate, 0.02);
  }
}

TEST(JudgeMotion, OfNothingDiesOut) {
  TeleoperationMotion still;
  still.time = {0.0, 1e-3, 2e-3, 3e-3};
  still.master_velocity = still.slave_velocity = {0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(judge(still).outcome, MotionOutcome::dies_out);
  EXPECT_EQ(judge(still).frequency.value, 0.0);
}

TEST(SimulateTeleoperation, RefusesRobotsWithoutMass) {
  Teleoperator massless = position_position();
  massless.values["slave.m"] = 0;
  MassSpringDamper hand(0.0, 0.0, 0.0), environment(0.0, 0.0, 0.0);
  const auto motion = simulate(setup(massless), hand, environment);
  ASSERT_FALSE(motion);
  EXPECT_NE(motion.error().line().find("mass_kg"), std::string::npos);
}

}  // namespace
}  // namespace mbk::laboratory
