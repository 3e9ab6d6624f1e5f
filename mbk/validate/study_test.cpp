#include "mbk/validate/study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "mbk/validate/rows.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace study_test {

/// Every share that the study judges is among those that its number of runs is made for.
void expect_enough_by_default(std::string_view name, const ValidationTable& table) {
  const Study& study = *std::ranges::find(studies(), name, &Study::name);
  for (const ValidationRow& row : table.rows) {
    if (!row.trials || !row.judged()) continue;
    const double trials_per_run = static_cast<double>(*row.trials) / table.runs;
    const int needed = min_runs({*row.expected, 95.0, trials_per_run});
    EXPECT_GE(min_runs(study), needed) << row.what;
    EXPECT_GE(default_runs(study), min_runs(study)) << row.what;
  }
}

void expect_nothing_refuted(const Result<ValidationTable>& table) {
  ASSERT_TRUE(table) << table.error().line();
  validation::expect_nothing_refuted(*table);
  expect_enough_by_default(table->study, *table);
}

TEST(Study, NamesAreUnlikeAndRefuseNoRuns) {
  std::set<std::string_view> names;
  for (const Study& study : studies()) {
    EXPECT_TRUE(names.insert(study.name).second) << study.name;
    EXPECT_GE(min_runs(study), 2);
    EXPECT_GE(default_runs(study), min_runs(study)) << study.name;
    EXPECT_FALSE(study.perform({.runs = 0})) << study.name;
  }
}

/// Fewer runs than a study needs never show all that it judges, whatever comes out.
TEST(Study, WithFewerRunsThanItNeedsSomeRowCannotBeMet) {
  for (const Study& study : studies()) {
    const int runs = min_runs(study) - 1;
    bool short_of_one = runs < 2;  // a mean takes two
    for (const JudgedShare& judged : study.shares) short_of_one |= min_runs(judged) > runs;
    EXPECT_TRUE(short_of_one) << study.name;
  }
  EXPECT_GE(default_runs(studies().front()), 2000);  // coverage
}

TEST(Spatial, IntervalsOfThreeAxesHoldAndWhatIsWrongIsTold) {
  const auto table = spatial_study({.runs = 30, .seed = 11});
  expect_nothing_refuted(table);
  EXPECT_GT(table->rows.size(), 50U);
}

TEST(Recovery, ARelaxedArmInTheClosedLoopIsFoundWithoutMuchBias) {
  const auto table = recovery_study({.runs = 20, .seed = 11});
  expect_nothing_refuted(table);
  EXPECT_EQ(table->rows.size(), 2U * 14 * 2);
  for (std::size_t k = 0; k < table->rows.size(); k += 2) {
    const ValidationRow &bias = table->rows[k], &held = table->rows[k + 1];
    EXPECT_GT(*bias.spread, 0.0) << bias.what;
    EXPECT_EQ(held.what, bias.what + ": 95 % interval holds the truth");
    EXPECT_TRUE(held.judged());
    EXPECT_NE(held.verdict(), RowVerdict::met) << "20 of 20 are no 85 %";
    EXPECT_GE(held.value, 60.0) << held.what;  // below that with probability 10⁻⁵ where it is 90 %
  }
}

TEST(Recovery, IsTheSameOnAnyNumberOfThreads) {
  const auto one = recovery_study({.runs = 2, .threads = 1}), two = recovery_study({.runs = 2, .threads = 2});
  ASSERT_TRUE(one && two);
  for (std::size_t k = 0; k < one->rows.size(); ++k) EXPECT_EQ(one->rows[k].value, two->rows[k].value);
}

TEST(MisspecificationStudy, WarnsWhereTheModelDoesNotHoldAndIsSilentWhereItDoes) {
  const auto table = misspecification_study({.runs = 2});
  ASSERT_TRUE(table.has_value()) << table.error().message;
  const auto warned = [](const ValidationRow& row) { return row.what.ends_with(": warned"); };
  EXPECT_GE(std::ranges::count_if(table->rows, warned), 40);
  EXPECT_GE(std::ranges::count_if(table->rows, &ValidationRow::judged), 30);
  expect_nothing_refuted(*table);
}

TEST(MisspecificationStudy, PerformsTheConditionsAskedForAndNoOthers) {
  const std::array<std::string, 2> two = {"force late by 20 ms", "multisine"};
  const auto table = misspecification_study({.runs = 1}, two);
  ASSERT_TRUE(table.has_value()) << table.error().message;
  EXPECT_EQ(table->rows.size(), 2u * 9);
  EXPECT_EQ(table->rows.front().what, "multisine: warned") << "in the order of the whole table";
  const std::array<std::string, 1> unknown = {"force late by 20 m"};
  const auto refused = misspecification_study({.runs = 1}, unknown);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().kind, ErrorKind::usage);
  EXPECT_NE(refused.error().remedy.find("force late by 20 ms;"), std::string::npos) << refused.error().remedy;
}

TEST(PassivityStudy, NeverCallsARelaxedArmActiveAndHearsTheEnergyOfOneThatActs) {
  const auto table = passivity_study({.runs = 3, .seed = 21});  // `mbk validate passivity` takes 500
  expect_nothing_refuted(table);
  EXPECT_EQ(table->rows.size(), 5u * 5 + 3);
  for (const ValidationRow& row : table->rows) {
    if (!row.judged()) continue;
    EXPECT_DOUBLE_EQ(row.value, row.expected == kNever ? 0.0 : 100.0) << row.what;
  }
}

TEST(LiveEstimate, ItsIntervalsHoldTheTruth) {
  const auto table = live_estimate_study({.runs = 30, .seed = 5});  // `mbk validate live-estimate` takes 500
  expect_nothing_refuted(table);
  ASSERT_EQ(table->rows.size(), 4u * 13 + 1);
  ASSERT_TRUE(table->rows.back().judged());
  for (std::size_t at = 0; at < 4; ++at) {
    const ValidationRow& mean = table->rows[13 * at];
    ASSERT_TRUE(mean.judged() == (at > 0) && table->rows[13 * at + 12].judged());
    EXPECT_GE(mean.value, 82.0)
        << mean.what;  // 90 % less three standard errors of the mean of 30 runs, each of spread 14 %
    double sum = 0.0;
    for (std::size_t k = 1; k <= 12; ++k) sum += table->rows[13 * at + k].value;
    EXPECT_NEAR(mean.value, sum / 12, 1e-9) << mean.what;
  }
}

TEST(LiveEstimate, IsTheSameOnAnyNumberOfThreads) {
  const auto one = live_estimate_study({.runs = 2, .threads = 1}), two = live_estimate_study({.runs = 2, .threads = 2});
  ASSERT_TRUE(one && two);
  for (std::size_t k = 0; k < one->rows.size(); ++k) EXPECT_EQ(one->rows[k].value, two->rows[k].value);
}

TEST(Springs, RigsOfBothTablesAreFound) {
  const auto table = springs_study({.runs = 1, .seed = 5});
  expect_nothing_refuted(table);
  EXPECT_EQ(table->rows.size(), 2u * (6 * 4 + 5 * 3 + 5));
  ASSERT_EQ(table->charts.size(), 2u);
  for (const ChartSeries& marks : table->charts[0].series) {
    for (std::size_t k = 0; k < marks.x.size(); ++k) EXPECT_NEAR(marks.y[k], marks.x[k], 8.0) << marks.name;
  }
}

TEST(OneDimensional, NoLinearModelHoldsForAnArmThatCorrectsAndOneDoesWhereItDoesNot) {
  const auto table = one_dimensional_study({.runs = 1});  // `mbk validate one-dimensional` takes more
  expect_nothing_refuted(table);
  ASSERT_EQ(table->charts.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(table->charts[2].series[2].y[k], table->charts[2].series[0].y[k]);
}

TEST(Participant, ThreeArmsBehaveAsPeopleDid) {
  const auto table = participant_study({.runs = 2});  // `mbk validate participant` takes ten seeds
  expect_nothing_refuted(table);
  ASSERT_EQ(table->charts.size(), 1u);
  EXPECT_EQ(table->charts[0].series.size(), 3u);
  bool said = false;
  for (const std::string& note : table->notes) said |= note.find("Dyck") != std::string::npos;
  EXPECT_TRUE(said);
}

}  // namespace study_test
}  // namespace mbk::validation
