#include "mbk/model/perturbation/stretches.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "mbk/model/perturbation/schedule.h"
#include "mbk/model/perturbation/schedule_plan.h"

namespace mbk::perturbation {
namespace stretches_test {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kExact = 1e-12;

Stretches make(const Stretches::Options& options) {
  auto made = Stretches::create(options);
  EXPECT_TRUE(made);
  return *made;
}

TEST(Stretches, VelocityIsConstantBetweenSmoothChangesAndTheAmplitudeIsReached) {
  for (const double amplitude : {1.2, -0.9}) {
    const Stretches schedule = make({.amplitude = amplitude, .speeds = {0.2, 2.0, 4.0}, .acceleration = 50.0});
    const double way = std::copysign(1.0, amplitude);
    for (const Stretches::Stretch& one : schedule.stretches()) {
      const double change = 1.5 * one.speed / 50.0;
      EXPECT_NEAR(one.fast - one.onset, change, kExact);
      EXPECT_NEAR(one.still - one.slowing, change, kExact);
      for (const double s : {0.2, 0.5, 0.9}) {
        const Jet<double> at = schedule.at(one.onset + s * change);
        EXPECT_NEAR(at.first, way * one.speed * (3.0 - 2.0 * s) * s * s, kExact);
        EXPECT_NEAR(at.value, way * one.speed * change * s * s * s * (1.0 - 0.5 * s), kExact);
        EXPECT_NEAR(at.second, way * 50.0 * 4.0 * s * (1.0 - s), 1e-9);
        EXPECT_NEAR(schedule.at(one.slowing + s * change).first, way * one.speed * (1.0 - (3.0 - 2.0 * s) * s * s),
                    kExact);
        const Jet<double> fast = schedule.at(one.fast + s * (one.slowing - one.fast));
        EXPECT_EQ(fast.first, way * one.speed);
        EXPECT_EQ(fast.second, 0.0);
        EXPECT_EQ(schedule.at(one.still + s * schedule.options().hold).value, amplitude);
      }
      for (const double edge : {one.fast, one.slowing, one.still, one.offset}) {  // without a jump
        EXPECT_NEAR(schedule.at(edge - 1e-9).value, schedule.at(edge + 1e-9).value, 1e-7);
        EXPECT_NEAR(schedule.at(edge - 1e-9).first, schedule.at(edge + 1e-9).first, 1e-6);
      }
    }
    EXPECT_EQ(schedule.at(schedule.end() + 0.1).value, 0.0);
    EXPECT_EQ(schedule.at(schedule.stretches().front().onset - 1e-6).value, 0.0);
  }
}

TEST(Stretches, TakeEverySpeedEquallyOftenInTheStatedOrder) {
  Stretches::Options options{.speeds = {0.2, 0.5, 1.0}, .repetitions = 6, .order = Stretches::Order::listed};
  const Stretches in_turn = make(options);
  for (std::size_t i = 0; i < in_turn.stretches().size(); ++i) {
    EXPECT_EQ(in_turn.stretches()[i].speed, options.speeds[i % 3]);
  }
  options.order = Stretches::Order::random;
  const Stretches shuffled = make(options);
  std::map<double, int> count;
  bool same = true;
  double rest = options.quiet;
  for (std::size_t i = 0; i < shuffled.stretches().size(); ++i) {
    const Stretches::Stretch& one = shuffled.stretches()[i];
    ++count[one.speed];
    same = same && one.speed == options.speeds[i % 3];
    EXPECT_GE(one.onset, rest + options.shortest_pause);
    EXPECT_LE(one.onset, rest + options.longest_pause);
    rest = one.offset + options.way_back;
  }
  EXPECT_FALSE(same);
  EXPECT_EQ(count, (std::map<double, int>{{0.2, 6}, {0.5, 6}, {1.0, 6}}));
}

TEST(Stretches, ScheduleHasTheirPeaksEventsAndBand) {
  const StretchPlan plan{.stretches = {.amplitude = 60.0 * kDegree, .speeds = {30.0 * kDegree, 180.0 * kDegree}}};
  const Schedule schedule = make_schedule({plan, {}, 2}, 3).value();
  const Facts facts = schedule.facts();
  EXPECT_NEAR(facts.peak, 60.0 * kDegree, kExact);
  EXPECT_NEAR(facts.peak_speed, 180.0 * kDegree, kExact);
  EXPECT_NEAR(facts.peak_acceleration, plan.stretches.acceleration, 1e-6);
  EXPECT_EQ(facts.axis_peak[1], 0.0);
  EXPECT_EQ(schedule.events().size(), 20U);
  EXPECT_EQ(schedule.reference(40.0), schedule.at(40.0).value);
  // a rectangle of 1/3 s has −3 dB at 0.4430/T; smooth ends of 0.09 s lower it a little
  EXPECT_LT(facts.highest_frequency.value, 0.4430 * 3.0);
  EXPECT_GT(facts.highest_frequency.value, 0.95 * 0.4430 * 3.0);
  EXPECT_FALSE(schedule.check({.speed = 179.0 * kDegree}));
}

TEST(Stretches, RefusesWhatCannotBeStretched) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const Stretches::Options& wrong : std::vector<Stretches::Options>{{.amplitude = 0.0},
                                                                         {.amplitude = kNaN},
                                                                         {.speeds = {}},
                                                                         {.speeds = {1.0, 0.0}},
                                                                         {.repetitions = 0},
                                                                         {.repetitions = 5000},
                                                                         {.acceleration = 0.0},
                                                                         {.hold = 0.0},
                                                                         {.way_back = 0.0},
                                                                         {.shortest_pause = 5.0},
                                                                         {.quiet = -1.0},
                                                                         {.amplitude = 0.1, .speeds = {2.0}}}) {
    EXPECT_FALSE(Stretches::create(wrong));
  }
}

}  // namespace stretches_test
}  // namespace mbk::perturbation
