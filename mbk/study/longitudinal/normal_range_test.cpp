#include "mbk/study/longitudinal/normal_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mbk::longitudinal {
namespace {

TEST(NormalRange, IsThePredictionIntervalOfOneFurtherPerson) {
  // mean 3, s² 2.5; t(0.975, 4) = 2.7764451 (tables); half = 2.7764451 √2.5 √1.2
  const NormalRange range = normal_range({1, 2, 3, 4, 5});
  EXPECT_EQ(range.controls, 5);
  EXPECT_DOUBLE_EQ(range.mean, 3.0);
  EXPECT_NEAR(range.range95.second - range.mean, 4.8089440, 1e-6);
  EXPECT_NEAR(range.mean - range.range95.first, 4.8089440, 1e-6);
}

TEST(NormalRange, IsNotKnownFromFewerThanFivePeopleOrWithoutVariation) {
  const NormalRange few = normal_range({1, 2, 3, 4});
  EXPECT_EQ(few.controls, 4);
  EXPECT_TRUE(std::isnan(few.mean));
  EXPECT_TRUE(std::isnan(few.range95.first));
  EXPECT_TRUE(std::isnan(normal_range({2, 2, 2, 2, 2}).range95.second));
  EXPECT_TRUE(std::isnan(normal_range({1, 2, 3, 4, kNaN}).range95.first));
  EXPECT_EQ(normal_range({}).controls, 0);
}

TEST(NormalRange, HoldsNineteenOfTwentyFurtherPeople) {
  constexpr int kStudies = 4000;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(10.0, 3.0);
  for (const int people : {5, 12}) {
    int inside = 0;
    for (int k = 0; k < kStudies; ++k) {
      std::vector<double> values;
      for (int p = 0; p < people; ++p) values.push_back(normal(random));
      inside += verdict_of(normal(random), normal_range(values)) == RangeVerdict::inside ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(inside) / kStudies, 0.95, 0.014) << people;  // 4 standard errors
  }
}

TEST(NormalRange, TellsAboveFromBelow) {
  const NormalRange range{6, 5.0, {4.0, 6.0}};
  EXPECT_EQ(verdict_of(6.1, range), RangeVerdict::above);
  EXPECT_EQ(verdict_of(3.9, range), RangeVerdict::below);
  EXPECT_EQ(verdict_of(4.0, range), RangeVerdict::inside);
  EXPECT_EQ(verdict_of(kNaN, range), RangeVerdict::unknown);
  EXPECT_EQ(verdict_of(5.0, NormalRange{}), RangeVerdict::unknown);
}

/// People 1 to 8 with the sessions 1 and 2 of two trials; in session 2 the value is 10 p.
store::OutcomeColumns eight_people() {
  store::OutcomeColumns columns{{"rest"}, {}, {{"K", "N/m", {}, {}}, {"stiffness_orientation", "°", {}, {}}}};
  for (int p = 1; p <= 8; ++p) {
    for (int s = 1; s <= 2; ++s) {
      for (int t = 1; t <= 2; ++t) {
        columns.trials.push_back({std::ssize(columns.trials) + 1, p, s, t, 0});
        columns.outcomes[0].values.push_back((s == 1 ? 1000.0 : 10.0 * p) + (t == 1 ? 1.0 : -1.0));
        columns.outcomes[0].standard_errors.push_back(t == 1 ? 3.0 : 4.0);
        columns.outcomes[1].values.push_back(90.0);
      }
    }
  }
  return columns;
}

TEST(OutcomeRanges, CompareTheLastSessionWithTheLastOfTheControls) {
  const auto ranges = outcome_ranges(eight_people(), 8, {1, 2, 3, 4, 5});
  ASSERT_EQ(ranges.size(), 1U);  // an orientation has no range
  EXPECT_EQ(ranges[0].session, 2);
  EXPECT_EQ(ranges[0].results, 2);
  EXPECT_DOUBLE_EQ(ranges[0].value, 80.0);
  EXPECT_DOUBLE_EQ(ranges[0].normal.mean, 30.0);
  EXPECT_EQ(ranges[0].normal.controls, 5);
  EXPECT_EQ(ranges[0].without, 0);
  EXPECT_EQ(ranges[0].verdict, RangeVerdict::above);
}

TEST(OutcomeRanges, ControlsWithoutTheNumberAreCounted) {
  auto columns = eight_people();
  for (std::size_t k = 0; k < columns.trials.size(); ++k) {
    if (columns.trials[k].participant == 2 && columns.trials[k].session == 2) columns.outcomes[0].values[k] = kNaN;
  }
  const auto ranges = outcome_ranges(columns, 8, {1, 2, 3, 4, 5});
  EXPECT_EQ(ranges.at(0).normal.controls, 4);
  EXPECT_EQ(ranges[0].without, 1);
  EXPECT_EQ(ranges[0].verdict, RangeVerdict::unknown);
}

TEST(SessionResults, ErrorOfAMeanIsFromTheErrorsOfItsResults) {
  const auto columns = eight_people();
  const SessionResult one = session_results(columns, columns.outcomes[0], 0).at(3).at(2);
  EXPECT_EQ(one.results, 2);
  EXPECT_DOUBLE_EQ(one.mean, 30.0);
  EXPECT_DOUBLE_EQ(one.standard_error, 2.5);  // √(3² + 4²)/2
}

}  // namespace
}  // namespace mbk::longitudinal
