#include "mbk/model/perturbation/ramp_and_hold.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/model/perturbation/schedule.h"

namespace mbk::perturbation {
namespace ramp_and_hold_test {

constexpr double kExact = 1e-15;

RampAndHold make(const RampAndHold::Options& options) {
  auto made = RampAndHold::create(options);
  EXPECT_TRUE(made);
  return *made;
}

TEST(RampAndHold, FollowsTheClosedFormOfMinimumJerk) {
  const RampAndHold schedule = make({.amplitude = 0.008, .ramp = 0.1, .hold = 0.4, .way_back = 0.2});
  for (const RampAndHold::Ramp& ramp : schedule.ramps()) {
    for (const double s : {0.1, 0.37, 0.5, 0.9}) {
      const double path = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
      EXPECT_NEAR((schedule.at(ramp.onset + 0.1 * s).value - 0.008 * path * ramp.direction_B).norm(), 0.0, 1e-12);
      EXPECT_NEAR((schedule.at(ramp.offset + 0.2 * s).value - 0.008 * (1.0 - path) * ramp.direction_B).norm(), 0.0,
                  1e-12);
    }
    // 15/8 A/D in the middle
    EXPECT_NEAR(schedule.at(ramp.onset + 0.05).first.norm(), 1.875 * 0.008 / 0.1, 1e-9);
  }
}

TEST(RampAndHold, RestsExactlyWhileItIsHeldAndBetweenRamps) {
  const RampAndHold schedule = make({.seed = 4});
  const RampAndHold::Options& o = schedule.options();
  double rest = 0.0;
  for (const RampAndHold::Ramp& ramp : schedule.ramps()) {
    EXPECT_EQ(schedule.at(0.5 * (rest + ramp.onset)).value, Eigen::Vector2d(0.0, 0.0));
    for (const double t : {ramp.onset + o.ramp + 1e-6, ramp.onset + o.ramp + 0.5 * o.hold, ramp.offset}) {
      EXPECT_NEAR((schedule.at(t).value - o.amplitude * ramp.direction_B).norm(), 0.0, kExact);
      EXPECT_EQ(schedule.at(t).first, Eigen::Vector2d(0.0, 0.0));
    }
    EXPECT_NEAR(ramp.offset - ramp.onset, o.ramp + o.hold, 1e-12);
    rest = ramp.offset + o.way_back;
  }
  EXPECT_EQ(schedule.end(), rest);
}

TEST(RampAndHold, TakesEachDirectionEquallyOftenWithPausesWithinTheRange) {
  const RampAndHold schedule = make({.directions = 8, .repetitions = 5, .seed = 9});
  std::array<int, 8> count{};
  double rest = schedule.options().quiet;
  bool in_turn = true;
  int before = -1;
  for (const RampAndHold::Ramp& ramp : schedule.ramps()) {
    ++count[static_cast<std::size_t>(ramp.direction)];
    EXPECT_GE(ramp.onset - rest, schedule.options().shortest_pause - 1e-9);
    EXPECT_LE(ramp.onset - rest, schedule.options().longest_pause + 1e-9);
    EXPECT_NEAR(
        std::remainder(ramp.angle - std::atan2(ramp.direction_B.y(), ramp.direction_B.x()), 2.0 * std::numbers::pi),
        0.0, 1e-12);
    rest = ramp.offset + schedule.options().way_back;
    in_turn = in_turn && ramp.direction == (before + 1) % 8;
    before = ramp.direction;
  }
  for (const int n : count) EXPECT_EQ(n, 5);
  EXPECT_FALSE(in_turn);
}

TEST(RampAndHold, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const RampAndHold one = make({.seed = 1}), same = make({.seed = 1}), other = make({.seed = 2});
  EXPECT_EQ(one.ramps()[3].onset, same.ramps()[3].onset);
  EXPECT_NE(one.ramps()[3].onset, other.ramps()[3].onset);
}

/// |∫ ṙ e^{−jωt} dt| over the path, by the midpoint rule: the plain twin of the closed form behind bandwidth().
TEST(RampAndHold, HasItsBandwidthWhereTheSpectrumOfTheVelocityIsHalfThePower) {
  const RampAndHold schedule = make({.amplitude = 1.0, .ramp = 0.12, .way_back = 0.3});
  const double omega = 2.0 * std::numbers::pi * schedule.bandwidth().value, onset = schedule.ramps().front().onset;
  double real = 0.0, imaginary = 0.0;
  constexpr int kPieces = 20000;
  for (int i = 0; i < kPieces; ++i) {
    const double t = 0.12 * (i + 0.5) / kPieces, speed = schedule.at(onset + t).first.norm() * 0.12 / kPieces;
    real += speed * std::cos(omega * t);
    imaginary -= speed * std::sin(omega * t);
  }
  EXPECT_NEAR(std::hypot(real, imaginary), std::numbers::sqrt2 / 2.0, 1e-4);
}

TEST(RampAndHold, RefusesWhatIsNoRamp) {
  using Options = RampAndHold::Options;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(RampAndHold::create({.amplitude = 0.0}));
  EXPECT_FALSE(RampAndHold::create({.amplitude = nan}));
  EXPECT_FALSE(RampAndHold::create({.ramp = 0.0}));
  EXPECT_FALSE(RampAndHold::create({.hold = -1.0}));
  EXPECT_FALSE(RampAndHold::create({.way_back = nan}));
  EXPECT_FALSE(RampAndHold::create({.directions = 0}));
  EXPECT_FALSE(RampAndHold::create({.repetitions = 0}));
  EXPECT_FALSE(RampAndHold::create({.directions = 360, .repetitions = 1000}));
  Options pauses;
  pauses.shortest_pause = 3.0;
  EXPECT_FALSE(RampAndHold::create(pauses));
  EXPECT_FALSE(RampAndHold::create({.quiet = -0.1}));
}

TEST(ScheduleOfRamps, HasTheFactsOfItsRamps) {
  const auto schedule = Schedule::ramps({.amplitude = 0.006, .ramp = 0.12, .repetitions = 1}, 1.0);
  ASSERT_TRUE(schedule) << schedule.error().line();
  const Facts facts = schedule->facts();
  EXPECT_NEAR(facts.peak, 0.006, 1e-9);
  EXPECT_NEAR(facts.peak_speed, 1.875 * 0.006 / 0.12, 1e-6);
  EXPECT_NEAR(facts.peak_acceleration, 10.0 / std::sqrt(3.0) * 0.006 / (0.12 * 0.12), 1e-5);
  EXPECT_NEAR(facts.highest_frequency.value, 0.6874 / 0.12, 1e-9);
  EXPECT_EQ(schedule->events().size(), 16U);
  EXPECT_EQ(schedule->reference(schedule->events()[0].time + 0.2),
            schedule->at(schedule->events()[0].time + 0.2).value);
}

TEST(ScheduleOfRamps, KeepsLimits) {
  const auto schedule = Schedule::ramps({.amplitude = 0.006, .repetitions = 1}, 1.0);
  ASSERT_TRUE(schedule);
  EXPECT_TRUE(schedule->check({.peak = 0.0061}));
  EXPECT_FALSE(schedule->check({.peak = 0.0059}));
  EXPECT_FALSE(schedule->check({.speed = 0.05}));
  const auto refused = schedule->check({.bandwidth = Hertz(3.0)});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("ramp"), std::string::npos);
  EXPECT_FALSE(Schedule::ramps({}, -1.0));
}

}  // namespace ramp_and_hold_test
}  // namespace mbk::perturbation
