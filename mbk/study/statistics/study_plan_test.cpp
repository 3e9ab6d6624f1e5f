#include "mbk/study/statistics/study_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::statistics {
namespace study_plan_test {

using reliability::Pairing;

/// A pilot of people × sessions × trials, drawn from variances.
store::OutcomeColumns pilot_columns(int people, int sessions, int trials, std::uint32_t seed) {
  numeric::Random random(seed);
  store::OutcomeColumns columns;
  columns.conditions = {"relaxed"};
  columns.outcomes = {{"K", "N/m", {}, {}}};
  for (int i = 1; i <= people; ++i) {
    const double own = 3.0 * random.normal();
    for (int j = 1; j <= sessions; ++j) {
      const double session = 1.0 * random.normal();
      for (int k = 1; k <= trials; ++k) {
        columns.trials.push_back({std::ssize(columns.trials) + 1, i, j, k, 0});
        columns.outcomes[0].values.push_back(100.0 + own + session + 2.0 * random.normal());
      }
    }
  }
  return columns;
}

Pilot stated() {
  Pilot pilot;
  pilot.variances = {9.0, 1.0, 4.0};
  return pilot;
}

TEST(APlan, OfStatedVariancesIsThatOfTheTTest) {
  PlanGoal goal;
  goal.difference = 3.0;
  goal.change = 5.0;
  goal.max_sessions = 2;
  goal.max_trials = 4;
  const auto plans = study_plans(stated(), goal);
  ASSERT_TRUE(plans) << plans.error().line();
  ASSERT_EQ(plans->size(), 8U);
  const StudyPlan& last = plans->back();
  const double error = (1.0 + 4.0 / 4) / 2;
  EXPECT_EQ(last.people.value,
            reliability::people_for_effect(3.0 / std::sqrt(9.0 + error), 0.8, Pairing::unpaired).value());
  EXPECT_GE(last.power.value, 0.8);
  EXPECT_NEAR(last.mdc95.value, 1.96 * std::numbers::sqrt2 * std::sqrt(error), 1e-12);
  EXPECT_TRUE(last.change_is_detectable.value());
  EXPECT_FALSE(plans->front().change_is_detectable.value());
  EXPECT_TRUE(std::isnan(last.people.interval95.first)) << "what is stated has no interval";
}

TEST(APlan, HasThePowerThatSimulatedStudiesShow) {
  for (const Pairing pairing : {Pairing::unpaired, Pairing::paired}) {
    PlanGoal goal;
    goal.difference = 2.5;
    goal.pairing = pairing;
    goal.max_trials = 2;
    goal.simulated_studies = 4000;
    const auto plans = study_plans(stated(), goal);
    ASSERT_TRUE(plans);
    for (const StudyPlan& plan : *plans) {
      EXPECT_NEAR(plan.simulated_power.value().value, plan.power.value, 0.03) << word_of(pairing);
    }
  }
}

TEST(APlan, OfAPilotSaysHowSureItIs) {
  // Of 100 pilots, the interval of the people needed holds the true number nearly always.
  PlanGoal goal;
  goal.difference = 3.0;
  goal.max_trials = 2;
  const double truth = study_plans(stated(), goal)->back().people.value;
  int held = 0;
  constexpr int kPilots = 100;
  for (std::uint32_t seed = 1; seed <= kPilots; ++seed) {
    const auto pilot = pilot_of(pilot_columns(10, 2, 3, seed), "K", {"relaxed"}, 100, seed);
    ASSERT_TRUE(pilot) << pilot.error().line();
    const auto plans = study_plans(*pilot, goal);
    ASSERT_TRUE(plans);
    const auto [low, high] = plans->back().people.interval95;
    if (low <= truth && truth <= high) ++held;
  }
  EXPECT_GE(held, 86);
}

TEST(APlan, OfOneTrialASessionPromisesNothingOfMoreTrials) {
  PlanGoal goal;
  goal.difference = 3.0;
  goal.change = 4.0;
  goal.max_sessions = 2;
  for (const int more : {0, 1}) {  // sessions with a second trial
    auto columns = pilot_columns(10, 2, 2, 5);
    for (std::size_t k = 1; k < columns.trials.size(); k += 2) {
      if (k > static_cast<std::size_t>(2 * more)) columns.outcomes[0].values[k] = kNaN;
    }
    const auto pilot = pilot_of(columns, "K", {"relaxed"}, 100, 1);
    ASSERT_TRUE(pilot) << pilot.error().line();
    EXPECT_TRUE(pilot->warns_of(ReliabilityWarning::sessions_and_trials));
    const auto plans = study_plans(*pilot, goal);
    ASSERT_TRUE(plans);
    ASSERT_EQ(plans->size(), 2U);
    for (const StudyPlan& plan : *plans) EXPECT_EQ(plan.trials, 1);
    EXPECT_NE(plan_text(*pilot, goal, *plans).find("! "), std::string::npos);
    const auto json = nlohmann::json::parse(to_json(*pilot, goal, *plans));
    EXPECT_TRUE(json["variance"]["session"].is_null() && json["variance"]["residual"].is_null());
    EXPECT_EQ(json["warnings"], nlohmann::json({"sessions-and-trials-not-identifiable"}));
  }
  const auto two = pilot_of(pilot_columns(10, 2, 2, 5), "K", {"relaxed"}, 100, 1);
  EXPECT_TRUE(two->warnings.empty());
  EXPECT_EQ(study_plans(*two, goal)->size(), 20U);
}

TEST(APlan, OfOneSessionPromisesNothingOfChanges) {
  const auto pilot = pilot_of(pilot_columns(10, 1, 3, 5), "K", {"relaxed"}, 100, 1);
  ASSERT_TRUE(pilot) << pilot.error().line();
  PlanGoal goal;
  goal.difference = 3.0;
  goal.max_sessions = 3;
  const auto plans = study_plans(*pilot, goal);
  ASSERT_TRUE(plans) << plans.error().line();
  EXPECT_EQ(plans->size(), 10U) << "one session";
  EXPECT_TRUE(std::isnan(plans->front().mdc95.value));
  EXPECT_GT(plans->front().people.value, 2.0);
  EXPECT_TRUE(nlohmann::json::parse(to_json(*pilot, goal, *plans))["plans"][0]["mdc95"].is_null());
  goal.pairing = Pairing::paired;
  EXPECT_FALSE(study_plans(*pilot, goal));
  EXPECT_FALSE(study_plans(*pilot, PlanGoal{.change = 4.0}));
}

TEST(APlan, IsNotMadeFromTooLittle) {
  EXPECT_FALSE(pilot_of(pilot_columns(4, 2, 3, 1), "K", {"relaxed"}, 100, 1)) << "four people";
  EXPECT_FALSE(pilot_of(pilot_columns(8, 1, 1, 1), "K", {"relaxed"}, 100, 1)) << "nothing repeats";
  EXPECT_FALSE(pilot_of(pilot_columns(8, 2, 1, 1), "B", {"relaxed"}, 100, 1)) << "another outcome";
  EXPECT_FALSE(pilot_of(pilot_columns(8, 2, 1, 1), "K", {"tensed"}, 100, 1)) << "another condition";
  EXPECT_FALSE(study_plans(stated(), {})) << "no target";
  PlanGoal negative;
  negative.difference = -1.0;
  EXPECT_FALSE(study_plans(stated(), negative));
  EXPECT_FALSE(study_plans(Pilot(), PlanGoal{.difference = 1.0})) << "no variance";
}

TEST(APlan, ForSoManyPeopleSaysTheirPower) {
  PlanGoal goal;
  goal.difference = 3.0;
  goal.people = 8;
  const auto plans = study_plans(stated(), goal);
  ASSERT_TRUE(plans);
  EXPECT_EQ(plans->front().people.value, 8);
  EXPECT_NEAR(plans->front().power.value, reliability::power_of_t_test(3.0 / std::sqrt(14.0), 8, Pairing::unpaired),
              1e-12);
}

}  // namespace study_plan_test
}  // namespace mbk::statistics
