#include "mbk/study/longitudinal/side_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

namespace mbk::longitudinal {
namespace {

TEST(SidePairs, DifferInTheWordLeftAndRightAlone) {
  const auto pairs = side_pairs({"rest-left", "rest-right", "Left", "right", "tensed-left", "leftover", "rightover"});
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].name, "rest");
  EXPECT_EQ(pairs[0].left, 0);
  EXPECT_EQ(pairs[0].right, 1);
  EXPECT_EQ(pairs[1].name, "");
  EXPECT_EQ(pairs[1].left, 2);
  EXPECT_EQ(pairs[1].right, 3);
  EXPECT_TRUE(side_pairs({"left-right", "right-left", ""}).empty());
}

/// People whose sides differ by 5 + `more` of person 1, in two sessions; a session moves left − right by ±1 or less.
store::OutcomeColumns both_sides(int people, double more, double standard_error = kNaN) {
  store::OutcomeColumns columns{{"left", "right"}, {}, {{"K", "N/m", {}, {}}}};
  for (int p = 1; p <= people; ++p) {
    for (int s = 1; s <= 2; ++s) {
      for (int side = 0; side < 2; ++side) {
        columns.trials.push_back({std::ssize(columns.trials) + 1, p, s, 1, side});
        const double own = 100.0 + 10.0 * p;
        columns.outcomes[0].values.push_back(
            side == 1 ? own : own + 5.0 + std::sin(9.7 * p + 5.3 * s) + (p == 1 ? more : 0.0));
        columns.outcomes[0].standard_errors.push_back(standard_error);
      }
    }
  }
  return columns;
}

TEST(SideDifference, IsJudgedByHowOthersVaryBetweenSessions) {
  const auto all = side_differences(both_sides(10, 30.0), 1, {2, 3, 4, 5, 6, 7, 8, 9, 10});
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].session, 2);
  EXPECT_NEAR(all[0].difference, 35.0, 1.0);
  EXPECT_DOUBLE_EQ(all[0].left - all[0].right, all[0].difference);
  EXPECT_EQ(all[0].basis, ErrorBasis::sessions);
  EXPECT_LT(all[0].error95.first, all[0].error);
  EXPECT_GT(all[0].error95.second, all[0].error);
  EXPECT_LT(all[0].error, 4.0);
  EXPECT_EQ(all[0].verdict, ChangeVerdict::beyond_error);
  EXPECT_EQ(all[0].normal.controls, 9);
  EXPECT_NEAR(all[0].normal.mean, 5.0, 0.5);
  EXPECT_EQ(all[0].range_verdict, RangeVerdict::above);
  // A difference that everybody has is more than error, and usual.
  const auto usual = side_differences(both_sides(10, 0.0), 1, {2, 3, 4, 5, 6, 7, 8, 9, 10});
  EXPECT_EQ(usual.at(0).verdict, ChangeVerdict::beyond_error);
  EXPECT_EQ(usual[0].range_verdict, RangeVerdict::inside);
}

TEST(SideDifference, OwnChangeDoesNotHideIt) {
  auto columns = both_sides(10, 30.0);
  columns.outcomes[0].values[0] -= 100.0;  // left of session 1
  EXPECT_EQ(side_differences(columns, 1, {}).at(0).error, side_differences(both_sides(10, 30.0), 1, {}).at(0).error);
}

TEST(SideDifference, NothingIsClaimedFromTheRecordingsAlone) {
  const auto all = side_differences(both_sides(4, 30.0, 0.5), 1, {2, 3, 4});
  EXPECT_EQ(all.at(0).basis, ErrorBasis::recordings);
  EXPECT_NEAR(all[0].error, 1.96 * 0.5 * std::sqrt(2.0), 1e-12);
  EXPECT_NE(all[0].why_unknown, "");
  EXPECT_EQ(all[0].verdict, ChangeVerdict::unknown);
  EXPECT_EQ(all[0].range_verdict, RangeVerdict::unknown);
  EXPECT_EQ(side_differences(both_sides(4, 30.0), 1, {}).at(0).basis, ErrorBasis::unknown);
  EXPECT_TRUE(side_differences(both_sides(1, 0.0), 2, {}).empty());
}

TEST(SideDifference, EqualSidesAreSeldomSaidToDiffer) {
  constexpr int kStudies = 400;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  int beyond = 0;
  for (int k = 0; k < kStudies; ++k) {
    store::OutcomeColumns columns{{"left", "right"}, {}, {{"K", "N/m", {}, {}}}};
    for (int p = 1; p <= 8; ++p) {
      const double own = p == 1 ? 0.0 : 5.0 * normal(random);  // others' sides differ
      for (int s = 1; s <= 2; ++s) {
        for (int side = 0; side < 2; ++side) {
          columns.trials.push_back({std::ssize(columns.trials) + 1, p, s, 1, side});
          columns.outcomes[0].values.push_back((side == 0 ? own : 0.0) + normal(random));
        }
      }
    }
    beyond += side_differences(columns, 1, {}).at(0).verdict == ChangeVerdict::beyond_error ? 1 : 0;
  }
  EXPECT_LT(beyond, 0.025 * kStudies);
}

}  // namespace
}  // namespace mbk::longitudinal
