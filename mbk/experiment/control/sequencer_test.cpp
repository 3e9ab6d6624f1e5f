#include "mbk/experiment/control/sequencer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mbk/model/robot/workspace.h"
#include "tests/support/allocations.h"

namespace mbk::control {
namespace sequencer_test {

using perturbation::Multisine;
using perturbation::Quantity;
using perturbation::Schedule;
using perturbation::Space;

constexpr double kTick = 1e-3;
const Vector2d kHome(0.30, -0.05), kStart(0.26, -0.02);

const robot::Geometry& geometry() {
  static const robot::Geometry geometry;
  return geometry;
}

Schedule pulses(Quantity quantity, double amplitude) {
  perturbation::PulseSchedule::Options options;
  options.amplitude = amplitude;
  options.directions = 2;
  options.repetitions = 1;
  return Schedule::pulses(options, quantity, 3.0).value();
}

Sequencer sequencer(const Mode& mode, const Schedule& schedule, const SequenceOptions& options = {}) {
  return Sequencer::create(TrialControl::create(mode, schedule, geometry(), kHome, kTick).value(), options, geometry(),
                           kTick)
      .value();
}

/// A robot that is always where it shall be; in between it stays.
std::vector<Sequencer::Step> follow(Sequencer& sequence, int end_early_at = -1) {
  std::vector<Sequencer::Step> steps;
  Vector2d joint = robot::joint_angles(geometry(), kStart).value();
  do {
    if (static_cast<int>(steps.size()) == end_early_at) sequence.end_early();
    steps.push_back(sequence.step(joint));
    if (steps.back().follows) joint = steps.back().joint_reference;
  } while (steps.back().phase != Phase::done && steps.size() < 200'000);
  return steps;
}

TEST(Sequencer, PassesEveryPhaseOnceInOrderAndTakesAsLongAsItSays) {
  const Schedule schedule = pulses(Quantity::position, 0.01);
  Sequencer sequence = sequencer(PositionMode{}, schedule);
  const double said = sequence.duration((kHome - kStart).norm());
  const auto steps = follow(sequence);
  std::vector<Phase> phases;
  for (const auto& step : steps) {
    if (phases.empty() || phases.back() != step.phase) phases.push_back(step.phase);
  }
  EXPECT_EQ(phases, (std::vector<Phase>{Phase::starting, Phase::moving, Phase::settling, Phase::perturbing,
                                        Phase::returning, Phase::stopping, Phase::done}));
  EXPECT_NEAR(static_cast<double>(steps.size() - 1) * kTick, said, 0.01);
}

TEST(Sequencer, MovesWithoutAJumpBelowItsSpeedAndInsideTheLimits) {
  SequenceOptions options;
  options.move_speed = 0.05;
  Sequencer sequence = sequencer(PositionMode{}, pulses(Quantity::position, 0.01), options);
  const auto steps = follow(sequence);
  Vector2d last = kStart;
  for (const auto& step : steps) {
    if (step.phase == Phase::done) break;
    const Vector2d hand = robot::hand_position(geometry(), step.joint_reference);
    EXPECT_TRUE(robot::check_joints(geometry().limits, step.joint_reference));
    if (step.phase == Phase::moving) {
      EXPECT_LT((hand - last).norm() / kTick, 1.02 * 0.05);
    }
    EXPECT_LT((hand - last).norm() / kTick, 0.3);
    last = hand;
  }
  EXPECT_LT((last - kHome).norm(), 1e-6);
}

TEST(Sequencer, HoldsTheTestLocationBeforeThePerturbation) {
  Sequencer sequence = sequencer(PositionMode{}, pulses(Quantity::position, 0.01));
  for (const auto& step : follow(sequence)) {
    if (step.phase == Phase::settling) {
      EXPECT_LT((step.reference - kHome).norm(), 1e-9);
    }
    EXPECT_EQ(step.perturbation_time >= 0.0, step.phase == Phase::perturbing);
  }
}

TEST(Sequencer, GainsGrowFromNothingAndFadeToIt) {
  Sequencer sequence = sequencer(PositionMode{}, pulses(Quantity::position, 0.01));
  const Vector2d start = robot::joint_angles(geometry(), kStart).value(), pushed = start + Vector2d(0.02, 0.0);
  EXPECT_EQ(sequence.step(start).torque, Vector2d::Zero());
  double largest = 0.0, last = 0.0;
  for (int i = 1; i < 999; ++i) {
    const double torque = std::abs(sequence.step(pushed).torque[0]);
    if (i > 50) {
      EXPECT_GE(torque, last - 1e-9);  // the velocity estimate of the first push has died away
    }
    last = torque;
    largest = std::max(largest, torque);
  }
  EXPECT_NEAR(last, 60.0 * 0.02, 0.01);
}

TEST(Sequencer, AForceTrialHandsOverFromHoldingAndGripsAgain) {
  Sequencer sequence = sequencer(ForceMode{}, pulses(Quantity::force, 2.0));
  const auto steps = follow(sequence);
  for (const auto& step : steps) {
    EXPECT_EQ(step.follows, step.phase != Phase::perturbing && step.phase != Phase::done);
    if (step.phase != Phase::perturbing) {
      EXPECT_EQ(step.reference, Vector2d::Zero());
    }
  }
}

TEST(Sequencer, EndsEarlyByGoingBack) {
  const Schedule schedule = pulses(Quantity::position, 0.01);
  Sequencer whole = sequencer(PositionMode{}, schedule), cut = sequencer(PositionMode{}, schedule);
  const auto all = follow(whole), some = follow(cut, 5000);
  EXPECT_EQ(some[5000].phase, Phase::returning);
  EXPECT_LT(some.size(), all.size());
  Sequencer early = sequencer(PositionMode{}, schedule);
  EXPECT_EQ(follow(early, 300)[300].phase, Phase::stopping);
}

TEST(Sequencer, BrakesAtOnceHoweverLongTheWayBackTakes) {
  SequenceOptions options;
  options.shortest_move = 5.0;
  Sequencer whole = sequencer(PositionMode{}, pulses(Quantity::position, 0.01), options), sequence = whole;
  const auto all = follow(whole);
  int fastest = 1;
  double speed = 0.0;
  for (int i = 1; i < static_cast<int>(all.size()) && all[static_cast<std::size_t>(i)].phase <= Phase::perturbing;
       ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double now = (all[at].joint_reference - all[at - 1].joint_reference).norm();
    if (all[at].phase == Phase::perturbing && now > speed) speed = now, fastest = i;
  }
  const auto steps = follow(sequence, fastest + 1);
  const auto end = std::ranges::find(steps, Phase::returning, &Sequencer::Step::phase);
  ASSERT_NE(end, steps.end());
  const Vector2d place = (end - 1)->joint_reference, rate = (place - (end - 2)->joint_reference) / kTick;
  ASSERT_GT(rate.norm(), 0.01);
  double away = 0.0;
  Vector2d last = place;
  for (auto step = end; step->phase == Phase::returning; ++step) {
    EXPECT_LT((step->joint_reference - last).norm() / kTick, 1.3 * rate.norm() + 0.02);
    last = step->joint_reference;
    away = std::max(away, (last - place).dot(rate.normalized()));
  }
  EXPECT_LT(away, 0.15 * rate.norm());  // 0.2 s to rest
}

TEST(Sequencer, RefusesPhasesThatNeverEnd) {
  // As ticks they would be no whole number any more, and a soft start over at once.
  const Schedule schedule = pulses(Quantity::position, 0.01);
  const auto trial = TrialControl::create(PositionMode{}, schedule, geometry(), kHome, kTick).value();
  for (double SequenceOptions::*time : {&SequenceOptions::soft_start, &SequenceOptions::shortest_move,
                                        &SequenceOptions::settle, &SequenceOptions::handover}) {
    SequenceOptions options;
    options.*time = 1e300;
    EXPECT_FALSE(Sequencer::create(trial, options, geometry(), kTick));
    options.*time = 3600.0;
    EXPECT_TRUE(Sequencer::create(trial, options, geometry(), kTick));
  }
  SequenceOptions slow;
  slow.move_speed = 1e-300;
  EXPECT_FALSE(Sequencer::create(trial, slow, geometry(), kTick));
}

TEST(Sequencer, DoesNotAllocate) {
  Sequencer sequence = sequencer(PositionMode{}, pulses(Quantity::position, 0.01));
  const Vector2d start = robot::joint_angles(geometry(), kStart).value();
  const long before = testing_support::allocations();
  for (int i = 0; i < 20'000; ++i) sequence.step(start);
  EXPECT_EQ(testing_support::allocations(), before);
}

TEST(TrialControl, RefusesWhatDoesNotGoTogether) {
  const auto refused = [](const Mode& mode, const Schedule& schedule, const Vector2d& home = kHome) {
    return !TrialControl::create(mode, schedule, geometry(), home, kTick);
  };
  EXPECT_TRUE(refused(PositionMode{}, pulses(Quantity::force, 2.0)));
  EXPECT_TRUE(refused(ForceMode{}, pulses(Quantity::position, 0.01)));
  EXPECT_TRUE(refused(PositionMode{}, pulses(Quantity::position, 0.5)));
  EXPECT_TRUE(refused(PositionMode{}, pulses(Quantity::position, 0.01), {2.0, 0.0}));
  EXPECT_FALSE(refused(PositionMode{}, pulses(Quantity::position, 0.01)));
  EXPECT_FALSE(refused(ForceMode{}, pulses(Quantity::force, 2.0)));
}

}  // namespace sequencer_test
}  // namespace mbk::control
