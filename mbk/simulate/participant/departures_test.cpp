#include "mbk/simulate/participant/departures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <utility>

#include "mbk/simulate/participant/arm.h"
#include "mbk/simulate/participant/compliant_grip.h"

namespace mbk::participant {
namespace departures_test {

constexpr double kTick = 0.001;
const Vector2d kRest(0.3, -0.05);

Departures made(const Departures::Options& options, std::uint64_t seed = 1) {
  auto departures = Departures::create(options, kRest, kTick, seed, 3);
  EXPECT_TRUE(departures.has_value());
  return *departures;
}

HandState<2> at(const Vector2d& away, const Vector2d& velocity = {0.0, 0.0}) {
  return {kRest + away, velocity, 0.0, 0.0};
}

TEST(Departures, AreNothingByDefault) {
  Departures none = made({});
  none.step(1.0, kRest + Vector2d(0.01, 0.0), Matrix2d::Identity());
  EXPECT_EQ(none.force(at({0.01, 0.02}, {0.3, 0.1})).norm(), 0.0);
}

TEST(Departures, DryFrictionResistsTheMotionWhateverItsSpeed) {
  const Departures friction = made({.dry_friction = 0.5});
  EXPECT_NEAR((friction.force(at({0.0, 0.0}, {1.0, 0.0})) - Vector2d(0.5, 0.0)).norm(), 0.0, 1e-4);
  EXPECT_NEAR((friction.force(at({0.0, 0.0}, {0.0, -0.1})) - Vector2d(0.0, -0.5)).norm(), 0.0, 1e-3);
}

TEST(Departures, HardeningGrowsWithTheCube) {
  const Departures cubic = made({.cubic_stiffness = 1e6});
  EXPECT_NEAR(cubic.force(at({0.005, 0.0})).x(), 0.125, 1e-12);
  EXPECT_NEAR(cubic.force(at({-0.01, 0.0})).x(), -1.0, 1e-12);
}

TEST(Departures, AReflexAnswersAfterItsDelay) {
  Departures reflex = made({.reflex_gain = 30.0, .reflex_delay = 0.005});
  for (int tick = 0; tick <= 10; ++tick) {
    reflex.step(tick * kTick, kRest + Vector2d(tick >= 3 ? 0.01 : 0.0, 0.0), Matrix2d::Zero());
    EXPECT_NEAR(reflex.force(at({0.0, 0.0})).x(), tick >= 8 ? 0.3 : 0.0, 1e-12) << tick;
  }
}

TEST(Departures, ARelaxingForceIsThatOfTheSpringsAtFirstAndNothingInTheEnd) {
  Departures relaxing = made({.relaxing_share = 0.3});
  const Vector2d away(0.01, 0.0);
  relaxing.step(0.0, kRest + away, 100.0 * Matrix2d::Identity());
  EXPECT_NEAR(relaxing.force(at({0.0, 0.0})).x(), 0.9, 0.01);
  for (int tick = 1; tick <= 500; ++tick) relaxing.step(tick * kTick, kRest + away, 100.0 * Matrix2d::Identity());
  EXPECT_NEAR(relaxing.force(at({0.0, 0.0})).x(), 0.3 * (std::exp(-5.0) + std::exp(-1.0) + std::exp(-1.0 / 3.0)), 1e-3);
  for (int tick = 501; tick <= 30000; ++tick) relaxing.step(tick * kTick, kRest + away, 100.0 * Matrix2d::Identity());
  EXPECT_NEAR(relaxing.force(at({0.0, 0.0})).x(), 0.0, 1e-6);
}

TEST(Departures, AStiffnessOnOneSideAddsTheSameForceBothWays) {
  Departures one_sided = made({.one_sided_share = 0.6});
  for (const double away : {0.01, -0.01}) {
    one_sided.step(0.0, kRest + Vector2d(away, 0.0), 100.0 * Matrix2d::Identity());
    EXPECT_NEAR(one_sided.force(at({0.0, 0.0})).x(), 0.6, 1e-12);
  }
  EXPECT_FALSE(Departures::create({.one_sided_share = 1.5}, kRest, kTick, 1, 3));
}

TEST(Departures, ATremorHasItsForceAndFrequency) {
  Departures tremor = made({.tremor_force = 1.0, .tremor_frequency = Hertz(5.0), .tremor_width = Hertz(0.0)});
  double power = 0.0;
  int crossings = 0;
  double before = 0.0;
  for (int tick = 0; tick < 10000; ++tick) {
    tremor.step(tick * kTick, kRest, Matrix2d::Zero());
    const double force = tremor.force(at({0.0, 0.0})).x();
    power += force * force;
    crossings += before < 0.0 && force >= 0.0 ? 1 : 0;
    before = force;
  }
  EXPECT_NEAR(power / 10000.0, 0.5, 0.01);
  EXPECT_NEAR(crossings, 50, 1);
}

TEST(Departures, AnEquilibriumThatMovesPullsWithTheStiffness) {
  Departures drift = made({.equilibrium_drift = {0.001, 0.0}});
  drift.step(10.0, kRest, 100.0 * Matrix2d::Identity());
  EXPECT_NEAR(drift.force(at({0.0, 0.0})).x(), -1.0, 1e-12);
}

TEST(Departures, WhatCannotBeIsRefused) {
  for (const Departures::Options& wrong :
       {Departures::Options{.dry_friction = -1.0}, Departures::Options{.dry_friction_speed = 0.0},
        Departures::Options{.reflex_delay = -0.1}, Departures::Options{.tremor_width = Hertz(-1.0)},
        Departures::Options{.cubic_stiffness = std::nan("")}}) {
    EXPECT_FALSE(Departures::create(wrong, kRest, kTick, 1, 3));
  }
}

impedance::Model limb() {
  return {2.0 * Matrix2d::Identity(), 8.0 * Matrix2d::Identity(), 100.0 * Matrix2d::Identity(), kRest};
}

Arm quiet_arm(std::vector<StiffnessAt> schedule = {}) {
  ArmOptions options = relaxed_arm_options();
  options.limb = limb();
  options.remnant.floor = 0.0;
  options.stiffness_schedule = std::move(schedule);
  auto arm = Arm::create(options, kTick);
  EXPECT_TRUE(arm.has_value());
  return *arm;
}

TEST(Departures, AStiffnessScheduleIsFollowed) {
  Arm arm = quiet_arm({{1.0, 1.0}, {2.0, 3.0}});
  for (const auto& [time, factor] : {std::pair{0.5, 1.0}, {1.5, 2.0}, {2.0, 3.0}, {9.0, 3.0}}) {
    arm.tick(time, kTick, at({0.0, 0.0}), {0.0, 0.0});
    EXPECT_NEAR(arm.impedance(kRest).K(0, 0), 100.0 * factor, 1e-9) << time;
  }
  Arm damped = quiet_arm({{1.0, 1.0, 1.0}, {2.0, 1.0, 3.0}});
  damped.tick(1.5, kTick, at({0.0, 0.0}), {0.0, 0.0});
  EXPECT_NEAR(damped.impedance(kRest).B(0, 0), 16.0, 1e-9);
  EXPECT_NEAR(damped.impedance(kRest).K(0, 0), 100.0, 1e-9);
  ArmOptions wrong = relaxed_arm_options();
  wrong.stiffness_schedule = {{2.0, 1.0}, {1.0, 1.0}};
  EXPECT_FALSE(Arm::create(wrong, kTick));
  wrong.stiffness_schedule = {{2.0, -1.0}};
  EXPECT_FALSE(Arm::create(wrong, kTick));
}

/// Force at a handle that moves on a sine, in amplitude and phase, against the same in closed form.
TEST(CompliantGrip, IsASpringBeforeTheLimb) {
  constexpr double kStiffness = 3000.0, kRatio = 0.1, kOmega = 2.0 * M_PI * 2.0, kAmplitude = 0.005;
  auto grip = CompliantGrip::create({kStiffness, kRatio}, quiet_arm());
  ASSERT_TRUE(grip.has_value());
  std::complex<double> found = 0.0;
  constexpr int kSettled = 5000, kTicks = 10000;  // ten periods after ten
  for (int tick = 0; tick < kTicks; ++tick) {
    const double t = tick * kTick;
    const auto state = [&](double when) {
      return at({kAmplitude * std::sin(kOmega * when), 0.0}, {kAmplitude * kOmega * std::cos(kOmega * when), 0.0});
    };
    grip->tick(t, kTick, state(t), {0.0, 0.0});
    if (tick < kSettled) continue;
    // −F over the tick, by its beginning, middle and end
    const double h = (grip->dynamics(state(t)).bias.x() + 4.0 * grip->dynamics(state(t + 0.5 * kTick)).bias.x() +
                      grip->dynamics(state(t + kTick)).bias.x()) /
                     6.0;
    found += h * std::exp(std::complex<double>(0.0, -kOmega * (t + 0.5 * kTick)));
  }
  found *= 2.0 / (kTicks - kSettled) / kAmplitude * std::complex<double>(0.0, 1.0);
  const std::complex<double> s(0.0, kOmega);
  const double damping = 2.0 * kRatio * std::sqrt(kStiffness * 2.0);
  const std::complex<double> of_limb = 2.0 * s * s + 8.0 * s + 100.0, of_grip = kStiffness + damping * s;
  const std::complex<double> expected = of_limb * of_grip / (of_limb + of_grip);
  EXPECT_NEAR(std::abs(found - expected) / std::abs(expected), 0.0, 0.01);
}

TEST(CompliantGrip, WhatCannotBeIsRefused) {
  EXPECT_FALSE(CompliantGrip::create({0.0, 0.1}, quiet_arm()));
  EXPECT_FALSE(CompliantGrip::create({1000.0, -0.1}, quiet_arm()));
}

}  // namespace departures_test
}  // namespace mbk::participant
