#include "mbk/model/perturbation/reach_schedule.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "mbk/model/perturbation/schedule.h"
#include "mbk/model/perturbation/schedule_plan.h"

namespace mbk::perturbation {
namespace reach_schedule_test {

constexpr double kRounding = 1e-12;

ReachSchedule make(const ReachSchedule::Options& options) {
  return ReachSchedule::create(options).value();
}

TEST(ReachSchedule, BeginsUndisturbedAndThenDisplacesEachDirectionEquallyOften) {
  const ReachSchedule schedule = make({.repetitions = 5, .undisturbed_first = 15, .undisturbed_between = 10});
  ASSERT_EQ(schedule.reaches().size(), 15U + 10U + 40U);
  std::array<int, 8> count{};
  int undisturbed = 0;
  for (std::size_t k = 0; k < schedule.reaches().size(); ++k) {
    const ReachSchedule::Reach& reach = schedule.reaches()[k];
    EXPECT_FALSE(k < 15 && reach.displaced) << k;
    undisturbed += reach.displaced ? 0 : 1;
    if (!reach.displaced) {
      EXPECT_EQ(reach.direction_B, Eigen::Vector2d(0.0, 0.0));
      continue;
    }
    EXPECT_NEAR(reach.direction_B.norm(), 1.0, kRounding);
    ++count[static_cast<std::size_t>(std::lround(reach.angle / 0.78539816339744831))];
  }
  EXPECT_EQ(undisturbed, 25);
  for (const int times : count) EXPECT_EQ(times, 5);
}

TEST(ReachSchedule, MixesUndisturbedReachesAmongTheDisplacedOnes) {
  const ReachSchedule schedule = make({.seed = 3});
  int changes = 0;
  for (std::size_t k = 21; k < schedule.reaches().size(); ++k) {
    changes += schedule.reaches()[k].displaced != schedule.reaches()[k - 1].displaced ? 1 : 0;
  }
  EXPECT_GT(changes, 15);
}

TEST(ReachSchedule, HoldsTheDisplacementBetweenMinimumJerkRamps) {
  const ReachSchedule schedule = make({.out = 0.1, .hold = 0.12, .back = 0.2});
  EXPECT_EQ(schedule.shape(0.0).value, 0.0);
  EXPECT_NEAR(schedule.shape(0.05).value, 0.5, kRounding);
  EXPECT_NEAR(schedule.shape(0.05).first, 1.875 / 0.1, 1e-9);  // 15/8 in the middle of a minimum-jerk path
  for (const double t : {0.1, 0.15, 0.22}) EXPECT_NEAR(schedule.shape(t).value, 1.0, kRounding);
  EXPECT_NEAR(schedule.shape(0.32).value, 0.5, kRounding);
  EXPECT_NEAR(schedule.shape(0.42).value, 0.0, kRounding);
  EXPECT_EQ(schedule.shape(0.5).value, 0.0);
}

TEST(ReachSchedule, ExpectsTheTriggerWhereTheExpectedWayPassesIt) {
  const ReachSchedule schedule = make({.reach = {0.06, 0.08}, .trigger = 0.03});
  for (const std::size_t k : {0U, 7U, 119U}) {
    EXPECT_NEAR(schedule.way(schedule.trigger_time(k)).norm(), 0.03, 1e-9);
  }
  EXPECT_EQ(schedule.way(1.0), Eigen::Vector2d(0.0, 0.0));  // quiet
  EXPECT_LT((schedule.way(schedule.begin(2) + 1.0) - Eigen::Vector2d(0.06, 0.08)).norm(), kRounding);
  EXPECT_LT(schedule.way(schedule.begin(3) - 1e-6).norm(), kRounding);
}

TEST(ReachSchedule, SaysAsAScheduleWhatTheDisplacementAsks) {
  Plan plan;
  plan.kind = ReachPlan{{.undisturbed_between = 3}, 2.0};
  const Schedule schedule = make_schedule(plan, 5).value();
  ASSERT_NE(schedule.reaches(), nullptr);
  EXPECT_EQ(schedule.quantity(), Quantity::position);
  EXPECT_NEAR(schedule.duration(), 3.0 + 103 * 3.0 + 2.0, kRounding);
  const Facts facts = schedule.facts();
  EXPECT_NEAR(facts.peak, 0.008, kRounding);
  EXPECT_NEAR(facts.peak_speed, 1.875 * 0.008 / 0.1, 1e-6);
  EXPECT_TRUE(schedule.events().empty());  // when the hand passes the trigger is known only then
  EXPECT_FALSE(schedule.check({.peak = 0.007}));
}

TEST(ReachSchedule, RefusesWhatItCannotDo) {
  EXPECT_FALSE(ReachSchedule::create({.amplitude = 0.0}));
  EXPECT_FALSE(ReachSchedule::create({.out = -0.1}));
  EXPECT_FALSE(ReachSchedule::create({.directions = 0}));
  EXPECT_FALSE(ReachSchedule::create({.repetitions = 2000}));
  EXPECT_FALSE(ReachSchedule::create({.undisturbed_first = 11}));
  EXPECT_FALSE(ReachSchedule::create({.undisturbed_between = -1}));
  EXPECT_FALSE(ReachSchedule::create({.reach = {0.0, 0.05}, .trigger = 0.05}));
  EXPECT_FALSE(ReachSchedule::create({.reach_time = 0.6, .interval = 1.1}));
  EXPECT_FALSE(ReachSchedule::create({.quiet = std::nan("")}));
  EXPECT_FALSE(Schedule::reaches({}, -1.0));
}

}  // namespace reach_schedule_test
}  // namespace mbk::perturbation
