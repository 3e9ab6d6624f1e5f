#include "mbk/experiment/control/reach_servo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mbk/base/numeric/random.h"
#include "mbk/experiment/control/sequencer.h"
#include "mbk/model/perturbation/minimum_jerk.h"
#include "mbk/model/perturbation/schedule.h"
#include "mbk/model/robot/workspace.h"
#include "tests/support/allocations.h"

namespace mbk::control {
namespace reach_servo_test {

constexpr double kTick = 1e-3, kReach = 0.8;
constexpr int kInterval = 2500, kBegin = 300;  // ticks
const Vector2d kHome(0.30, -0.12);

const robot::Geometry& geometry() {
  static const robot::Geometry geometry;
  return geometry;
}

perturbation::ReachSchedule::Options options() {
  perturbation::ReachSchedule::Options options;
  options.repetitions = 2;
  options.undisturbed_first = 15;
  options.undisturbed_between = 5;
  options.trigger = 0.1;
  options.reach_time = kReach;
  options.interval = 2.5;
  return options;
}

ReachServo make(const perturbation::ReachSchedule::Options& o = options()) {
  return ReachServo::create({{1000.0, 1000.0}, {20.0, 20.0}}, perturbation::ReachSchedule::create(o).value(),
                            geometry(), kHome, kTick)
      .value();
}

/// A hand that reaches in every interval, by minimum jerk, in a time and to a place of its own.
class Hand {
 public:
  explicit Hand(std::uint64_t seed) : random_(seed) {}
  [[nodiscard]] Vector2d at(int tick) {
    const int number = tick / kInterval, since = tick % kInterval - kBegin;
    while (static_cast<int>(all_.size()) <= number) {
      all_.push_back({kReach * (1.0 + 0.05 * random_.normal()),
                      {0.004 * random_.normal(), 0.25 * (1.0 + 0.03 * random_.normal())}});
    }
    const One& one = all_[static_cast<std::size_t>(number)];
    const perturbation::MinimumJerk out({0, 0, 0}, {1, 0, 0}, one.duration), back({1, 0, 0}, {0, 0, 0}, 0.8);
    const double t = since * kTick;
    return kHome + (t < 1.2 ? out.at(t).value : back.at(t - 1.2).value) * one.way;
  }

 private:
  struct One {
    double duration;
    Vector2d way;
  };
  numeric::Random random_;
  std::vector<One> all_;
};

/// What the servo does of one reach.
struct Seen {
  int triggers = 0, holding = 0;
  bool displaced = false;
  double error = 0.0;                  ///< of the predicted way, 170 ms after the trigger [m]
  Vector2d displacement = {0.0, 0.0};  ///< largest [m]
};

Vector2d angles_of(const Vector2d& hand) {
  return robot::joint_angles(geometry(), hand).value();
}

/// A hand that goes its way whatever the servo does, so that the servo's reference can be compared with it.
std::vector<Seen> watched(ReachServo& servo, Hand hand, int reaches) {
  std::vector<Seen> all(static_cast<std::size_t>(reaches));
  int since = -1;
  for (int tick = 0; tick < reaches * kInterval; ++tick) {
    Seen& seen = all[static_cast<std::size_t>(tick / kInterval)];
    const Vector2d now = hand.at(tick), torque = servo.step(angles_of(now));
    if (servo.triggered()) {
      ++seen.triggers;
      since = 0;
    }
    seen.holding += servo.holding() ? 1 : 0;
    seen.displaced = seen.displaced || servo.following();
    if (servo.displacement().norm() > seen.displacement.norm()) seen.displacement = servo.displacement();
    if (!servo.following() && servo.displacement().norm() > 0.0) ADD_FAILURE() << "displaced and not followed";
    if (servo.following() && since == 170) {
      seen.error = (robot::hand_position(geometry(), servo.joint_reference()) - servo.displacement() - now).norm();
    }
    EXPECT_TRUE(seen.displaced || torque == Vector2d(0.0, 0.0)) << "the hand is free";
    if (since >= 0) ++since;
  }
  return all;
}

TEST(ReachServo, DisplacesTheReachesOfTheScheduleAndNoOther) {
  ReachServo servo = make();
  const auto reaches = perturbation::ReachSchedule::create(options()).value().reaches();
  const auto all = watched(servo, Hand(1), static_cast<int>(reaches.size()) + 2);
  std::size_t next = 0;  // a displacement may wait for a reach that can be predicted
  int waited = 0;
  for (const Seen& seen : all) {
    if (next == reaches.size()) {
      EXPECT_EQ(seen.triggers, 0) << "there is no more to do";
      continue;
    }
    EXPECT_EQ(seen.triggers, 1);
    if (reaches[next].displaced && !seen.displaced) {
      ++waited;
      continue;
    }
    EXPECT_EQ(seen.displaced, reaches[next].displaced);
    EXPECT_LT((seen.displacement - 0.008 * reaches[next].direction_B).norm(), 1e-12);
    EXPECT_NEAR(seen.holding, seen.displaced ? 100 : 0, 2);
    ++next;
  }
  EXPECT_LE(waited, 2);
}

TEST(ReachServo, FollowsTheWayOfTheHandBetterThanTheMeanReachWould) {
  perturbation::ReachSchedule::Options o = options();
  o.undisturbed_first = 30;
  ReachServo servo = make(o);
  const auto all = watched(servo, Hand(2), 51);
  double squares = 0.0;
  int displaced = 0;
  for (const Seen& seen : all) {
    if (!seen.displaced) continue;
    squares += seen.error * seen.error;
    ++displaced;
  }
  ASSERT_GT(displaced, 10);
  // 5 % of the duration move the hand by 15 mm and more there; a third of it is left
  EXPECT_LT(std::sqrt(squares / displaced), 0.003);
}

TEST(ReachServo, BeginsWithoutAJerk) {
  ReachServo servo = make();
  Hand hand(3);
  for (int tick = 0; tick < 30 * kInterval; ++tick) {
    const Vector2d torque = servo.step(angles_of(hand.at(tick)));
    // 0.3 N·m: what the lag of the velocity's filter, 1.6 ms at 3 m/s² and 20 N·m·s/rad, comes to
    EXPECT_TRUE(!servo.triggered() || torque.norm() < 0.4) << torque.transpose();
  }
}

TEST(ReachServo, TakesNoMotionForAReachThatIsSlowOrAsideOrWithoutRestBefore) {
  ReachServo servo = make();
  int triggers = 0;
  const auto go = [&](const Vector2d& way, double duration) {
    const perturbation::MinimumJerk out({0, 0, 0}, {1, 0, 0}, duration);
    for (int i = 0; i < 500; ++i) servo.step(angles_of(kHome));
    for (int i = 0; i * kTick < duration; ++i) {
      servo.step(angles_of(kHome + out.at(i * kTick).value * way));
      triggers += servo.triggered() ? 1 : 0;
    }
    for (int i = 0; i < 800; ++i) {
      servo.step(angles_of(kHome + (1.0 - i / 800.0) * way));
      triggers += servo.triggered() ? 1 : 0;
    }
  };
  go({0.0, 0.25}, 5.0);
  EXPECT_EQ(triggers, 0) << "slow";
  go({0.1, 0.12}, 0.8);
  EXPECT_EQ(triggers, 0) << "aside";
  for (int i = 0; i < 2000; ++i) {  // through home at speed
    servo.step(angles_of(kHome + Vector2d(0.0, 0.12 * std::sin(i * kTick * 9.0))));
    triggers += servo.triggered() ? 1 : 0;
  }
  EXPECT_EQ(triggers, 0) << "no rest";
  go({0.0, 0.25}, 0.8);
  EXPECT_EQ(triggers, 1);
}

TEST(ReachServo, LeavesAReachAloneThatIsUnlikeAllOthersAndDisplacesTheNext) {
  perturbation::ReachSchedule::Options o = options();
  o.undisturbed_between = 0;
  ReachServo servo = make(o);
  Hand hand(4);
  bool displaced = false;
  const auto run = [&](int from, int to, double scale) {
    displaced = false;
    for (int tick = from; tick < to; ++tick) {
      const Vector2d away = hand.at(tick) - kHome;
      servo.step(angles_of(kHome + Vector2d(away.x() + scale * away.y(), away.y())));
      displaced = displaced || servo.following();
    }
    return displaced;
  };
  EXPECT_FALSE(run(0, 15 * kInterval, 0.0));
  EXPECT_FALSE(run(15 * kInterval, 16 * kInterval, 0.4)) << "obliquely";
  bool any = false;
  for (int k = 16; k < 19; ++k) any = run(k * kInterval, (k + 1) * kInterval, 0.0) || any;
  EXPECT_TRUE(any);
}

TEST(ReachServo, DoesNotAllocate) {
  ReachServo servo = make();
  Hand hand(5);
  std::vector<Vector2d> angles;
  for (int tick = 0; tick < 25 * kInterval; ++tick) angles.push_back(angles_of(hand.at(tick)));
  const long before = testing_support::allocations();
  int following = 0;
  for (const Vector2d& measured : angles) {
    servo.step(measured);
    following += servo.following() ? 1 : 0;
  }
  EXPECT_EQ(testing_support::allocations(), before);
  EXPECT_GT(following, 300);
  angles.reserve(angles.capacity() + 1);
  EXPECT_GT(testing_support::allocations(), before);  // it is counted
}

TEST(ReachServo, RefusesWhatItCannotDo) {
  const auto made = [](perturbation::ReachSchedule::Options o, double tick) {
    return ReachServo::create({}, perturbation::ReachSchedule::create(o).value(), geometry(), kHome, tick).has_value();
  };
  EXPECT_TRUE(made(options(), kTick));
  EXPECT_FALSE(made(options(), 0.0015)) << "10 ms are no multiple of it";
  perturbation::ReachSchedule::Options o = options();
  o.hold = 0.5;
  EXPECT_FALSE(made(o, kTick)) << "longer than the prediction";
  o = options();
  o.reach = {0.0, 0.6};
  EXPECT_FALSE(made(o, kTick)) << "out of reach";
}

TEST(Sequencer, LeavesAHandThatReachesFreeAndSaysWhenItPassesTheTrigger) {
  const perturbation::Schedule schedule = perturbation::Schedule::reaches(options(), 0.5).value();
  const auto control = TrialControl::create(PositionMode{}, schedule, geometry(), kHome, kTick).value();
  EXPECT_FALSE(control.follows_position());
  EXPECT_LT((control.place(schedule.reaches()->trigger_time(0)) - kHome - Vector2d(0.0, 0.1)).norm(), 1e-9);
  Sequencer sequence = Sequencer::create(control, {}, geometry(), kTick).value();
  Hand hand(6);
  int triggers = 0, tick = 0;
  for (Sequencer::Step step; (step = sequence.step(angles_of(hand.at(tick)))).phase != Phase::returning;) {
    if (step.phase != Phase::perturbing) continue;
    EXPECT_TRUE(step.reference.norm() < 0.0081);
    triggers += step.triggered ? 1 : 0;
    ++tick;
  }
  EXPECT_GE(triggers, 30);
}

}  // namespace reach_servo_test
}  // namespace mbk::control
