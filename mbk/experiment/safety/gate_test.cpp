#include "mbk/experiment/safety/gate.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/allocations.h"

namespace mbk::safety {
namespace gate_test {

constexpr double kTick = 1e-3;
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
const Vector2d kHome(0.30, -0.05);

const robot::Geometry& geometry() {
  static const robot::Geometry geometry;
  return geometry;
}

/// Its force, motion and torques follow no dynamics: what the motion shows of the motors is looked at elsewhere.
Limits without_torque(Limits limits = {}) {
  limits.torque_error = 0.0;
  return limits;
}

Gate gate(const Limits& limits = {}) {
  return Gate::create(without_torque(limits), robot::PlanarRobot{geometry()}, kHome, kTick).value();
}

double handle_force(const Vector2d& joint, const Vector2d& torque) {
  return (robot::jacobian(geometry(), joint).transpose().inverse() * torque).norm();
}

/// A hand that goes round in a circle of 10 mm once a second, with sensors that agree and never rest.
Observation moving(int tick) {
  const double t = tick * kTick, w = 2.0 * std::numbers::pi, r = 0.01;
  const Vector2d out(std::cos(w * t), std::sin(w * t));
  Observation seen;
  seen.time = seen.state.time = t;
  seen.state.joint = robot::joint_angles(geometry(), kHome + r * out).value();
  seen.state.acceleration = -r * w * w * out + Vector2d(1e-6 * tick, 0.0);
  seen.state.force = {3.0 * std::sin(w * t), 1.0 + 1e-6 * tick};
  seen.joint_reference = seen.state.joint;
  seen.follows = seen.perturbing = true;
  return seen;
}

/// Runs to `ticks` without a trip, then with `spoil` until it trips.   @returns  ticks from then to the trip; −1: none
int ticks_to_trip(Gate& gate, const std::function<void(Observation&, Vector2d&, int)>& spoil, int most = 2000) {
  constexpr int kBegin = 600;
  for (int i = 0; i < kBegin; ++i) {
    gate.step(moving(i), {0.5 * std::sin(0.02 * i), 0.5 * std::cos(0.02 * i)});
    EXPECT_FALSE(gate.tripped()) << sentence(gate.trip());
  }
  for (int i = kBegin; i < kBegin + most; ++i) {
    Observation seen = moving(i);
    Vector2d asked(0.5 * std::sin(0.02 * i), 0.5 * std::cos(0.02 * i));
    spoil(seen, asked, i - kBegin);
    gate.step(seen, asked);
    if (gate.tripped()) return i - kBegin;
  }
  return -1;
}

struct Fault {
  Reason reason;
  int longest;  // ticks until it must have tripped
  std::function<void(Observation&, Vector2d&, int)> spoil;
};

class EveryFault : public testing::TestWithParam<Fault> {};

TEST_P(EveryFault, TripsInTimeForItsReasonAndBringsTheTorqueToZero) {
  Gate g = gate();
  const int ticks = ticks_to_trip(g, GetParam().spoil);
  ASSERT_GE(ticks, 0);
  EXPECT_LE(ticks, GetParam().longest);
  EXPECT_EQ(word_of(g.trip().reason), word_of(GetParam().reason)) << sentence(g.trip());
  Gate::Decision last = g.history().back().decision;
  for (int k = 1; k < kRampTicks; ++k) {
    EXPECT_TRUE(last.enabled);
    const Gate::Decision now = g.step(moving(700 + k), {100.0, -100.0});
    EXPECT_LE(now.torque.norm(), last.torque.norm() + 1e-15);
    last = now;
  }
  EXPECT_EQ(last.torque, Vector2d::Zero());
  EXPECT_FALSE(last.enabled);
  EXPECT_TRUE(g.off());
  EXPECT_FALSE(g.step(moving(800), {1.0, 1.0}).enabled);
}

INSTANTIATE_TEST_SUITE_P(
    Gate, EveryFault,
    testing::Values(
        Fault{Reason::stop_button, 0, [](Observation& o, Vector2d&, int) { o.state.stop = true; }},
        Fault{Reason::operator_stop, 0, [](Observation& o, Vector2d&, int) { o.operator_stop = true; }},
        Fault{Reason::link_lost, 0, [](Observation& o, Vector2d&, int) { o.link = false; }},
        Fault{Reason::link_lost, 10, [](Observation& o, Vector2d&, int) { o.fresh = false; }},
        Fault{Reason::late, 0, [](Observation& o, Vector2d&, int) { o.late = 0.03; }},
        Fault{Reason::recording_failed, 0, [](Observation& o, Vector2d&, int) { o.recording = false; }},
        Fault{Reason::controller_not_finite, 0, [](Observation&, Vector2d& a, int) { a[1] = kNotANumber; }},
        Fault{Reason::encoder_not_finite, 0, [](Observation& o, Vector2d&, int) { o.state.joint[0] = kNotANumber; }},
        Fault{Reason::force_not_finite, 0, [](Observation& o, Vector2d&, int) { o.state.force[1] = kNotANumber; }},
        Fault{Reason::accelerometer_not_finite, 0,
              [](Observation& o, Vector2d&, int) { o.state.acceleration[0] = kNotANumber; }},
        Fault{Reason::encoder_jump, 0, [](Observation& o, Vector2d&, int) { o.state.joint[1] += 0.03; }},
        Fault{Reason::force_jump, 0, [](Observation& o, Vector2d&, int) { o.state.force[0] += 25.0; }},
        Fault{Reason::force_frozen, 260,
              [](Observation& o, Vector2d&, int) {
                o.state.force = {1.0, 2.0};
              }},
        Fault{Reason::accelerometer_frozen, 260,
              [](Observation& o, Vector2d&, int) {
                o.state.acceleration = {0.1, 0.1};
              }},
        Fault{Reason::encoder_frozen, 300,
              [](Observation& o, Vector2d&, int) {
                o.state.joint[0] = moving(600).state.joint[0];
                o.joint_reference = o.state.joint;
                o.robot.has_acceleration = false;
              }},
        Fault{Reason::accelerometer_disagrees, 60,
              [](Observation& o, Vector2d&, int) { o.state.acceleration += Vector2d(6.0, 0.0); }},
        Fault{Reason::measured_force, 300, [](Observation& o, Vector2d&, int k) { o.state.force[0] += 0.2 * k; }},
        Fault{Reason::tracking, 0, [](Observation& o, Vector2d&, int) { o.joint_reference[1] += 0.3; }},
        Fault{Reason::limited_too_long, 110, [](Observation&, Vector2d& a, int) {
                a = {40.0, 40.0};
              }}));

/// The hand leaves along a straight line, faster and faster, with an accelerometer that says so.
int ticks_until_it_is_too_far(Gate& g, double acceleration) {
  return ticks_to_trip(g, [&](Observation& seen, Vector2d&, int k) {
    const double t = k * kTick;
    const Vector2d away =
        robot::hand_position(geometry(), moving(600 + k).state.joint) + Vector2d(0.0, 0.5 * acceleration * t * t);
    const auto angles = robot::joint_angles(geometry(), away);
    if (angles) seen.state.joint = *angles;
    seen.state.acceleration[1] += acceleration;
    seen.follows = false;
  });
}

TEST(Gate, StopsAHandThatIsTooFast) {
  Limits limits;
  limits.speed = 0.3;
  Gate g = gate(limits);
  ASSERT_GE(ticks_until_it_is_too_far(g, 3.0), 0);
  EXPECT_EQ(g.trip().reason, Reason::speed) << sentence(g.trip());
  EXPECT_NEAR(g.trip().value, 0.3, 0.02);
}

TEST(Gate, StopsAHandThatLeavesItsPlace) {
  Gate g = gate();
  ASSERT_GE(ticks_until_it_is_too_far(g, 0.4), 0);
  EXPECT_EQ(g.trip().reason, Reason::excursion) << sentence(g.trip());

  Limits limits;
  limits.excursion = 0.0;
  limits.workspace_high = {1.0, kHome.y() + 0.03};
  Gate boxed = gate(limits);
  ASSERT_GE(ticks_until_it_is_too_far(boxed, 0.4), 0);
  EXPECT_EQ(boxed.trip().reason, Reason::workspace) << sentence(boxed.trip());

  limits.workspace_high = {1.0, 1.0};
  limits.speed = 10.0;
  limits.joint_margin = 0.45;  // there are 0.52 rad at home
  Gate jointed = gate(limits);
  ASSERT_GE(ticks_until_it_is_too_far(jointed, 0.4), 0);
  EXPECT_EQ(jointed.trip().reason, Reason::joint_margin) << sentence(jointed.trip());
}

TEST(Gate, StopsAHandThatIsShaken) {
  Limits limits;
  limits.speed = 10.0;
  limits.accelerometer = 0.0;
  limits.acceleration = 8.0;
  Gate g = gate(limits);
  const int ticks = ticks_to_trip(g, [](Observation& seen, Vector2d&, int k) {
    const double growing = std::min(1.0, k / 200.0);
    seen.state.joint += growing * Vector2d::Constant(0.01 * std::sin(2.0 * std::numbers::pi * 10.0 * k * kTick));
    seen.follows = false;
  });
  ASSERT_GE(ticks, 0);
  EXPECT_EQ(g.trip().reason, Reason::acceleration) << sentence(g.trip());
}

TEST(Gate, NeverLetsMoreForceTorqueOrRatePassWhateverIsAsked) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Limits limits;
  limits.max_saturation_time = 60.0;  // so that it goes on
  limits.handle_force = 12.0;
  limits.joint_torque = {3.0, 2.0};
  Gate g = gate(limits);
  Vector2d last = Vector2d::Zero(), asked = Vector2d::Zero();
  int cut = 0;
  for (int i = 0; i < 50'000; ++i) {
    asked = 0.99 * asked + 2.0 * Vector2d(normal(random), normal(random));
    const Observation seen = moving(i);
    const Gate::Decision decision = g.step(seen, asked);
    ASSERT_FALSE(g.tripped()) << sentence(g.trip());
    EXPECT_LE(handle_force(seen.state.joint, decision.torque), 12.0 * (1.0 + 1e-12));
    EXPECT_LE(std::abs(decision.torque[0]), 3.0);
    EXPECT_LE(std::abs(decision.torque[1]), 2.0);
    EXPECT_TRUE(decision.cut || (decision.torque - asked).norm() < 1e-9);
    cut += decision.cut ? 1 : 0;
    last = decision.torque;
  }
  EXPECT_GT(cut, 1000);
  EXPECT_LT(cut, 50'000);
}

TEST(Gate, LetsPassUnchangedWhatKeepsTheLimits) {
  Gate g = gate();
  for (int i = 0; i < 3000; ++i) {
    const Vector2d asked(std::sin(0.01 * i), 0.5 * std::cos(0.02 * i) - 0.5);
    EXPECT_EQ(g.step(moving(i), asked).torque, asked);
  }
}

TEST(Gate, KeepsTheFirstReasonUntilItIsReset) {
  Gate g = gate();
  Observation seen = moving(0);
  seen.state.stop = true;
  g.step(seen, {0.0, 0.0});
  EXPECT_EQ(g.trip().reason, Reason::stop_button);
  EXPECT_FALSE(g.reset()) << "while the motors are still ramped down";
  for (int i = 1; i <= kRampTicks; ++i) {
    seen = moving(i);
    seen.state.stop = true;
    seen.state.force[0] = kNotANumber;
    g.step(seen, {0.0, 0.0});
  }
  EXPECT_EQ(g.trip().reason, Reason::stop_button);
  EXPECT_TRUE(g.off());
  EXPECT_FALSE(g.reset()) << "while the button is pressed";
  g.step(moving(50), {0.0, 0.0});
  ASSERT_TRUE(g.reset());
  EXPECT_FALSE(g.tripped());
  EXPECT_TRUE(g.step(moving(51), {0.1, 0.0}).enabled);
}

TEST(Gate, FindsAnEncoderThatCountsBackwardsInASmallMotion) {
  for (const Eigen::Index joint : {0, 1}) {
    Gate g = gate();
    const double at = moving(600).state.joint[joint];
    const int ticks = ticks_to_trip(g, [&](Observation& seen, Vector2d&, int) {
      seen.state.joint[joint] = 2.0 * at - seen.state.joint[joint];
      seen.follows = false;
    });
    EXPECT_GT(ticks, 0);
    EXPECT_LT(ticks, 1000);
    EXPECT_EQ(g.trip().reason, Reason::accelerometer_disagrees) << sentence(g.trip());
    EXPECT_LT(g.trip().limit, 0.5);  // of 4 m/s² over 40 ms
  }
}

/// Ticks until it trips where so many of ten ticks ask for too much; −1: never.
int ticks_of_swinging(int beyond) {
  Gate g = gate();
  Vector2d sent(0.0, 0.0);
  for (int i = 0; i < 2000; ++i) {
    const double sign = i / 10 % 2 == 0 ? 40.0 : -40.0;
    sent = g.step(moving(i), i % 10 < beyond ? Vector2d(sign, sign) : sent).torque;
    if (g.tripped()) {
      EXPECT_EQ(g.trip().reason, Reason::limited_too_long);
      return i;
    }
  }
  return -1;
}

TEST(Gate, AControllerThatSwingsBetweenItsLimitsIsStoppedToo) {
  // of ten ticks n count up by one and 10 − n down by a quarter: 100 ms are full after 1000 / (n − (10 − n) / 4) ticks
  EXPECT_NEAR(ticks_of_swinging(6), 200, 10);
  EXPECT_NEAR(ticks_of_swinging(4), 400, 10);
  EXPECT_EQ(ticks_of_swinging(2), -1);
}

/// A robot without friction that the gate's torque drives for real, on the end of a hand like a spring.
class Driven : public testing::Test {
 protected:
  /// What the motors exert of a command, and what the robot says of it.
  std::function<Vector2d(const Vector2d& commanded, bool enabled)> motors =
      [](const Vector2d& commanded, bool enabled) { return enabled ? commanded : Vector2d(0.0, 0.0); };
  std::function<void(Observation&)> spoil = [](Observation&) {};

  Driven() {
    robot_.geometry = geometry();
    robot_.friction = {};
    joint_ = robot::joint_angles(geometry(), kHome).value();
  }

  /// One millisecond.
  void tick(const Vector2d& asked) {
    const Vector2d hand = robot::hand_position(geometry(), joint_);
    const Vector2d velocity = robot::jacobian(geometry(), joint_) * rate_;
    const Vector2d force = -(150.0 * (hand - kHome) + 12.0 * velocity) + Vector2d(0.0, 1e-6 * ticks_);
    Observation seen;
    seen.time = kTick * ticks_;
    seen.state.joint = joint_;
    seen.state.force = force;
    seen.robot.has_acceleration = false;
    seen.state.time = 10.0 + seen.time;
    seen.robot.acknowledges = true;
    seen.state.answered = sent_;
    seen.state.motors = decision_.enabled ? Motors::on : Motors::off;
    spoil(seen);
    const Vector2d torque = motors(decision_.torque, decision_.enabled);
    decision_ = gate_.step(seen, asked);
    ++sent_;
    ++ticks_;
    constexpr int kSteps = 10;
    for (int i = 0; i < kSteps; ++i) {
      rate_ += kTick / kSteps * robot_.acceleration(joint_, rate_, torque, force);
      joint_ += kTick / kSteps * rate_;
    }
  }

  static Vector2d asked(int i) { return {0.6 * std::sin(0.015 * i), 0.6 * std::cos(0.011 * i) - 0.6}; }

  int drive(int most) {
    for (int i = 0; i < most && !gate_.tripped(); ++i) tick(asked(static_cast<int>(ticks_)));
    return static_cast<int>(ticks_);
  }
  void settle() {
    for (int i = 0; i < 700 && !gate_.settled(); ++i) tick({0.0, 0.0});
  }

  robot::PlanarRobot robot_;
  Vector2d joint_, rate_ = {0.0, 0.0};
  Gate gate_ = Gate::create(
                   Limits{},
                   [] {
                     robot::PlanarRobot robot;
                     robot.friction = {};
                     return robot;
                   }(),
                   kHome, kTick)
                   .value();
  Gate::Decision decision_;
  std::uint64_t sent_ = 0, ticks_ = 0;
};

TEST_F(Driven, MotorsThatFollowAreConfirmedOff) {
  drive(2000);
  ASSERT_FALSE(gate_.tripped()) << sentence(gate_.trip());
  EXPECT_EQ(gate_.motors().state, MotorsOff::State::not_asked);
  gate_.release();
  settle();
  EXPECT_FALSE(gate_.tripped()) << sentence(gate_.trip());
  EXPECT_EQ(gate_.motors().state, MotorsOff::State::confirmed) << sentence(gate_.motors());
  EXPECT_TRUE(gate_.motors().by_motion);
  EXPECT_LT(gate_.motors().after, 0.06);
}

TEST_F(Driven, MotorsThatPullTheWrongWayAreSeenInTheMotion) {
  drive(500);
  motors = [](const Vector2d& commanded, bool) { return Vector2d(-commanded); };
  const int found = drive(1000);
  EXPECT_EQ(gate_.trip().reason, Reason::torque_disagrees) << sentence(gate_.trip());
  EXPECT_LT(found, 800);
}

TEST_F(Driven, MotorsThatStayOnTheLastTorqueAreNeverCalledOff) {
  drive(1800);
  ASSERT_FALSE(gate_.tripped());
  motors = [held = Vector2d(0.9, -0.7)](const Vector2d&, bool) { return held; };
  gate_.release();
  settle();  // flag and answer say "off"; the hand is pushed all the same
  EXPECT_EQ(gate_.motors().state, MotorsOff::State::missing) << sentence(gate_.motors());
  EXPECT_EQ(gate_.motors().why, MotorsOff::Why::motion);
  EXPECT_EQ(gate_.trip().reason, Reason::motors_on);
  EXPECT_FALSE(gate_.reset()) << "while the motors may be on";
  gate_.see_idle(false, true);
  EXPECT_TRUE(gate_.reset());
}

TEST_F(Driven, EachMissingPartOfAConfirmationIsNamed) {
  struct Case {
    MotorsOff::Why why;
    std::function<void(Observation&)> spoil;
  };
  const std::vector<Case> cases = {
      {MotorsOff::Why::flag, [](Observation& o) { o.state.motors = Motors::on; }},
      {MotorsOff::Why::not_answered, [](Observation& o) { o.state.answered = 2; }},
      {MotorsOff::Why::no_state, [](Observation& o) { o.fresh = false; }},
      {MotorsOff::Why::no_state, [](Observation& o) { o.link = false; }},
      {MotorsOff::Why::drives,
       [](Observation& o) {
         o.state.drives_measure = true;
         o.state.drive_torque = {0.0, 2.0};
       }},
  };
  for (const Case& one : cases) {
    SetUp();
    gate_ = Gate::create(Limits{}, robot_, kHome, kTick).value();
    sent_ = ticks_ = 0;
    decision_ = {};
    spoil = [](Observation&) {};
    drive(300);
    gate_.release();
    spoil = one.spoil;
    settle();
    EXPECT_EQ(gate_.motors().state, MotorsOff::State::missing);
    EXPECT_EQ(gate_.motors().why, one.why) << sentence(gate_.motors());
    EXPECT_NE(sentence(gate_.motors()).find("NOT CONFIRMED OFF"), std::string::npos);
  }
}

TEST_F(Driven, ARobotThatSaysNothingOfItsMotorsIsNotCalledOff) {
  spoil = [](Observation& o) { o.robot.acknowledges = false; };
  drive(300);
  ASSERT_FALSE(gate_.tripped()) << sentence(gate_.trip());
  gate_.release();
  settle();
  EXPECT_EQ(gate_.motors().state, MotorsOff::State::cannot_say);
}

/// From the first state on, whatever its stamp: before the first command nothing was told, and nothing is measured.
TEST_F(Driven, DrivesThatMeasureWhatTheyAreToldNeverTrip) {
  spoil = [this](Observation& o) {
    o.state.time += 1e4;
    o.state.drives_measure = true;
    o.state.drive_torque = decision_.torque;
  };
  drive(1500);
  EXPECT_FALSE(gate_.tripped()) << sentence(gate_.trip());
}

TEST_F(Driven, DrivesThatMeasureAnotherTorqueTrip) {
  drive(300);
  spoil = [this](Observation& o) {
    o.state.drives_measure = true;
    o.state.drive_torque = decision_.torque + Vector2d(0.0, 0.8);
  };
  const int found = drive(1000);
  EXPECT_EQ(gate_.trip().reason, Reason::torque_disagrees);
  EXPECT_LE(found, 300 + 55);
}

TEST(Gate, KeepsTheLastTwoSeconds) {
  Gate g = gate();
  for (int i = 0; i < 5000; ++i) g.step(moving(i), {0.1, 0.0});
  const auto moments = g.history();
  ASSERT_EQ(moments.size(), 2000U);
  EXPECT_NEAR(moments.front().seen.time, 3.0, 1e-9);
  EXPECT_NEAR(moments.back().seen.time, 4.999, 1e-9);
}

TEST(Gate, DoesNotAllocate) {
  Gate g = gate();
  std::vector<Observation> seen;
  for (int i = 0; i < 3000; ++i) seen.push_back(moving(i));
  seen[2500].state.force[0] = kNotANumber;
  const long before = testing_support::allocations();
  for (const Observation& one : seen) g.step(one, {0.3, 0.2});
  EXPECT_EQ(testing_support::allocations(), before);
  EXPECT_TRUE(g.off());
}

TEST(Limits, AreRefusedOutsideTheirRange) {
  const auto refused = [](auto change) {
    Limits limits;
    change(limits);
    return !Gate::create(limits, robot::PlanarRobot{geometry()}, kHome, kTick);
  };
  EXPECT_TRUE(refused([](Limits& l) { l.handle_force = 0.0; }));
  EXPECT_TRUE(refused([](Limits& l) { l.joint_torque[1] = -1.0; }));
  EXPECT_TRUE(refused([](Limits& l) { l.speed = kNotANumber; }));
  EXPECT_TRUE(refused([](Limits& l) { l.workspace_low = {2.0, 0.0}; }));
  EXPECT_FALSE(refused([](Limits&) {}));
}

TEST(Trip, EveryReasonHasItsOwnCodeAndWords) {
  std::vector<std::string> codes;
  for (int i = 0; i < kReasons; ++i) {
    const Trip trip{static_cast<Reason>(i), 1.5, 3, 2.0, 7.25};
    codes.emplace_back(word_of(trip.reason));
    EXPECT_NE(sentence(trip).find("1.500 s"), std::string::npos);
    EXPECT_EQ(sentence(trip).find("7.25") == std::string::npos, unit(trip.reason).empty());
  }
  std::ranges::sort(codes);
  EXPECT_EQ(std::ranges::adjacent_find(codes), codes.end());
}

}  // namespace gate_test
}  // namespace mbk::safety
