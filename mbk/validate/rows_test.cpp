#include "mbk/validate/rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::validation {
namespace rows_test {

using enum RowVerdict;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

ValidationRow row(double value, std::optional<Range> interval, std::optional<Range> expected) {
  ValidationRow row;
  row.value = value;
  row.interval95 = interval;
  row.expected = expected;
  return row;
}

TEST(RowVerdict, IsMetOnlyWhereTheWholeIntervalLiesInside) {
  EXPECT_EQ(row(95.0, Range{92.0, 98.0}, kNominal).verdict(), met);  // the ends belong to the range
  EXPECT_EQ(row(95.0, Range{91.99, 98.0}, kNominal).verdict(), not_shown);
  EXPECT_EQ(row(95.0, Range{92.0, 98.01}, kNominal).verdict(), not_shown);
  EXPECT_EQ(row(3.0, Range{-kInfinity, kInfinity}, Range{-5.0, 5.0}).verdict(), not_shown);
  EXPECT_EQ(row(3.0, Range{1.0, 5.0}, at_most(5.0)).verdict(), met);
  EXPECT_EQ(row(3.0, Range{1.0, 5.0}, at_least(1.01)).verdict(), not_shown);
}

TEST(RowVerdict, FallsShortWhereTheIntervalLiesOutside) {
  EXPECT_EQ(row(92.0, Range{80.0, 97.0}, kNominal).verdict(), not_shown);
  EXPECT_EQ(row(91.99, Range{80.0, 97.0}, kNominal).verdict(), not_shown);
  EXPECT_EQ(row(91.0, Range{80.0, 91.99}, kNominal).verdict(), falls_short);
  EXPECT_EQ(row(98.01, Range{97.0, 99.0}, kNominal).verdict(), not_shown);
  EXPECT_EQ(row(98.6, Range{98.01, 99.0}, kNominal).verdict(), falls_short);
  EXPECT_EQ(row(50.0, Range{40.0, 60.0}, kNominal).verdict(), falls_short);
  EXPECT_EQ(row(std::nan(""), Range{0.0, kInfinity}, kNominal).verdict(), falls_short);
}

TEST(RowVerdict, OfWhatIsNoEstimateIsThatOfTheValue) {
  EXPECT_EQ(row(0.0, {}, Range{0.0, 0.0}).verdict(), met);
  EXPECT_EQ(row(1.0, {}, Range{0.0, 0.0}).verdict(), falls_short);
  EXPECT_EQ(row(std::nan(""), {}, at_least(0.0)).verdict(), falls_short);
}

TEST(RowVerdict, IsInformativeWithoutARange) {
  EXPECT_EQ(row(1.0, Range{0.0, 2.0}, {}).verdict(), informative);
  EXPECT_TRUE(row(1.0, Range{0.0, 2.0}, {}).met());
}

TEST(RowVerdict, TwoTrialsShowNothing) {
  EXPECT_EQ(share_row("", 2, 2, kNominal).verdict(), not_shown);  // no share of two lies within 92 to 98 %
  EXPECT_EQ(share_row("", 2, 2, kNearNominal).verdict(), not_shown);
  EXPECT_EQ(share_row("", 0, 2, kHardlyEver).verdict(), not_shown);
  EXPECT_EQ(share_row("", 0, 0, kHardlyEver).verdict(), not_shown);
  EXPECT_EQ(share_row("", 1, 2, kNearNominal).verdict(), not_shown);
  EXPECT_EQ(share_row("", 0, 2, kNominal).verdict(), falls_short);  // its interval ends at 84.2 %
}

TEST(RowVerdict, OfATableIsThatOfItsWorstRow) {
  const ValidationRow good = row(0.0, {}, Range{0.0, 0.0}), bad = row(1.0, {}, Range{0.0, 0.0}),
                      open = share_row("", 2, 2, kNearNominal), told = row(1.0, {}, {});
  ValidationTable table;
  EXPECT_EQ(table.verdict(), not_shown);
  table.rows = {told};
  EXPECT_EQ(table.verdict(), not_shown);  // nothing is judged
  table.rows = {good, told};
  EXPECT_EQ(table.verdict(), met);
  table.rows = {good, open, told};
  EXPECT_EQ(table.verdict(), not_shown);
  EXPECT_FALSE(table.met());
  table.rows = {open, bad, good};
  EXPECT_EQ(table.verdict(), falls_short);
}

/// Of the same share, fewer trials never show more.
TEST(RowVerdict, DroppingRunsNeverTurnsWhatIsNotMetIntoMet) {
  for (const Range& expected : {kNominal, kNearNominal, kNearlyAlways, kHardlyEver, kAlways}) {
    for (const int trials : {20, 50, 100, 200}) {
      for (int hits = 0; hits <= trials; ++hits) {
        bool was_met = share_row("", hits, trials, expected).verdict() == met;
        for (const int times : {2, 5, 20}) {
          const bool is_met = share_row("", times * hits, times * trials, expected).verdict() == met;
          EXPECT_TRUE(is_met || !was_met) << hits << " of " << trials << ", times " << times;
          was_met = is_met;
        }
      }
    }
  }
}

/// What truly lies at an end of the range, or beyond, is met by chance in at most 2.5 % of all studies of any size.
TEST(RowVerdict, FewRunsDoNotMakeItEasier) {
  for (const int trials : {1, 2, 5, 20, 72, 160, 226, 400, 1000, 2000}) {
    EXPECT_LE(chance_to_be_met(kNominal, 92.0, trials), 0.025 + 1e-9) << trials;
    EXPECT_LE(chance_to_be_met(kNominal, 98.0, trials), 0.025 + 1e-9) << trials;
    EXPECT_LE(chance_to_be_met(kHardlyEver, 5.0, trials), 0.025 + 1e-9) << trials;
    EXPECT_LE(chance_to_be_met(kNearlyAlways, 90.0, trials), 0.025 + 1e-9) << trials;
    EXPECT_LE(chance_to_be_met(kNominal, 86.2, trials), 1e-4) << trials;
  }
}

TEST(ShareRow, HasTheIntervalOfClopperAndPearson) {
  const ValidationRow row = share_row("x", 95, 100, kNominal);
  EXPECT_DOUBLE_EQ(row.value, 95.0);
  EXPECT_NEAR(row.interval95->first, 88.7165, 1e-3);
  EXPECT_NEAR(row.interval95->second, 98.3568, 1e-3);
  EXPECT_EQ(row.trials, 100);
}

TEST(MeanRow, HasTheIntervalOfStudentAndNoneOfOneRun) {
  const ValidationRow row = mean_row("x", Vector{{1.0, 2.0, 3.0}}, at_most(5.0), "N");
  const double t = 0.95 * std::sqrt(2.0 / (1.0 - 0.95 * 0.95));  // 2 degrees of freedom
  const double reach = t / std::sqrt(3.0);
  EXPECT_NEAR(row.interval95->first, 2.0 - reach, 1e-12);
  EXPECT_NEAR(row.interval95->second, 2.0 + reach, 1e-12);
  EXPECT_EQ(row.verdict(), met);
  EXPECT_EQ(mean_row("x", Vector{{2.0}}, Range{-5.0, 5.0}, "N").verdict(), not_shown);
  EXPECT_EQ(mean_row("x", Vector{{7.0}}, Range{-5.0, 5.0}, "N").verdict(), not_shown);
}

TEST(MedianRow, LiesBetweenOrderedValues) {
  // P(fewer than 2 of 10 below the median) = 11/1024: 2.1 % on both sides; of 3 it would be 10.9 %.
  const Vector values{{9.0, 1.0, 8.0, 2.0, 7.0, 3.0, 6.0, 4.0, 5.0, 10.0}};
  const ValidationRow row = median_row("x", values, at_least(2.0), "N");
  EXPECT_EQ(row.value, 5.5);
  EXPECT_EQ(row.interval95, Range(2.0, 9.0));
  EXPECT_EQ(row.verdict(), met);
  EXPECT_EQ(median_row("x", values.head(5), at_least(0.0), "N").verdict(), not_shown);
  EXPECT_EQ(median_row("x", values.head(6), {}, "N").interval95, Range(1.0, 9.0));
}

/// Each interval holds what it is of in 95 % of many studies (3 σ of 2000: 1.5 %), or in more where it counts.
TEST(Rows, IntervalsHoldTheTruth) {
  constexpr int kStudies = 2000, kRuns = 12;
  int mean = 0, median = 0, spread = 0;
  numeric::Random random(7, 1);
  const auto holds = [](const ValidationRow& row, double truth) {
    return row.interval95->first <= truth && truth <= row.interval95->second ? 1 : 0;
  };
  for (int study = 0; study < kStudies; ++study) {
    Vector values(kRuns);
    for (double& value : values) value = 3.0 + 2.0 * random.normal();
    mean += holds(mean_row("", values, {}, ""), 3.0);
    median += holds(median_row("", values, {}, ""), 3.0);
    spread += holds(spread_row("", values, 2.0, {0.5, 1.5}), 1.0);
  }
  EXPECT_NEAR(100.0 * mean / kStudies, 95.0, 1.5);
  EXPECT_NEAR(100.0 * spread / kStudies, 95.0, 1.5);
  EXPECT_NEAR(100.0 * median / kStudies, 96.1, 1.4);  // between the third from either end: 1 − 2·79/4096
}

TEST(Runs, AreAsManyAsTheIntervalNeeds) {
  EXPECT_EQ(min_runs({kNominal, 95.0}), 226);
  EXPECT_EQ(min_runs({kNearlyAlways, 100.0}), 72);  // 0.025^(1/72) = 95.01 %
  EXPECT_EQ(min_runs({kHardlyEver, 0.0}), 72);      // 0.025^(1/72) = 95.01 %
  EXPECT_EQ(min_runs({kHardlyEver, 0.0, 3.0}), 24);
  EXPECT_EQ(min_runs({kHardlyEver, 0.0, 0.5}), 144);
  EXPECT_EQ(default_runs({kNominal, 95.0}), 2000);
  EXPECT_EQ(default_runs({kNearNominal, 95.0}), 250);
  EXPECT_EQ(default_runs({kNearlyAlways, 100.0}), 100);
  EXPECT_NEAR(chance_to_be_met(kNominal, 95.0, 400), 0.5, 0.1);
}

}  // namespace rows_test
}  // namespace mbk::validation
