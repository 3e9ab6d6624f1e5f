#include "mbk/study/validation/study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace mbk::validation {
namespace study_test {

void expect_met(const Result<ValidationTable>& table) {
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_FALSE(table->rows.empty());
  for (const ValidationRow& row : table->rows) {
    EXPECT_TRUE(row.met()) << row.what << ": " << row.value << ", 99 % interval " << row.interval99.first << " to "
                           << row.interval99.second;
  }
}

TEST(Study, NamesAreUnlikeAndRefuseNoRuns) {
  std::set<std::string_view> names;
  for (const Study& study : studies()) {
    EXPECT_TRUE(names.insert(study.name).second) << study.name;
    EXPECT_GT(study.runs, 0);
    EXPECT_FALSE(study.perform({.runs = 0})) << study.name;
  }
}

TEST(Recovery, ARelaxedArmInTheClosedLoopIsFoundWithoutMuchBias) {
  const auto table = recovery_study({.runs = 20, .seed = 11});
  expect_met(table);
  for (const ValidationRow& row : table->rows) {
    EXPECT_GT(*row.spread, 0.0) << row.what;
    EXPECT_GE(*row.coverage, 0.6) << row.what;  // below that with probability 10⁻⁵ where it is 90 %
  }
}

TEST(Recovery, IsTheSameOnAnyNumberOfThreads) {
  const auto one = recovery_study({.runs = 2, .threads = 1}), two = recovery_study({.runs = 2, .threads = 2});
  ASSERT_TRUE(one && two);
  for (std::size_t k = 0; k < one->rows.size(); ++k) EXPECT_EQ(one->rows[k].value, two->rows[k].value);
}

TEST(LiveEstimate, ItsIntervalsHoldTheTruth) {
  const auto table = live_estimate_study({.runs = 30, .seed = 5});  // `mbk validate live-estimate` takes 200
  expect_met(table);
  ASSERT_EQ(table->rows.size(), 4u * 13);
  for (std::size_t at = 0; at < 4; ++at) {
    const ValidationRow& mean = table->rows[13 * at];
    ASSERT_TRUE(mean.judged());
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
  expect_met(table);
  EXPECT_EQ(table->rows.size(), 2u * (6 * 4 + 5 * 3 + 5));
  ASSERT_EQ(table->charts.size(), 2u);
  for (const ChartSeries& marks : table->charts[0].series) {
    for (std::size_t k = 0; k < marks.x.size(); ++k) EXPECT_NEAR(marks.y[k], marks.x[k], 8.0) << marks.name;
  }
}

TEST(OneDimensional, NoLinearModelHoldsForAnArmThatCorrectsAndOneDoesWhereItDoesNot) {
  const auto table = one_dimensional_study({.runs = 1});  // `mbk validate one-dimensional` takes more
  expect_met(table);
  ASSERT_EQ(table->charts.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(table->charts[2].series[2].y[k], table->charts[2].series[0].y[k]);
}

TEST(Participant, ThreeArmsBehaveAsPeopleDid) {
  const auto table = participant_study({.runs = 3});  // `mbk validate participant` takes ten seeds
  expect_met(table);
  ASSERT_EQ(table->charts.size(), 1u);
  EXPECT_EQ(table->charts[0].series.size(), 3u);
  bool said = false;
  for (const std::string& note : table->notes) said |= note.find("tuned") != std::string::npos;
  EXPECT_TRUE(said);
}

}  // namespace study_test
}  // namespace mbk::validation
