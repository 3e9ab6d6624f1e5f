#include "mbk/validate/coverage.h"

#include <gtest/gtest.h>

#include "mbk/validate/rows.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace {

TEST(Coverage, NominalNinetyFivePercentIntervalsHoldTheTruthThatOften) {
  const auto table = coverage({.runs = 160, .seed = 1});
  ASSERT_TRUE(table) << table.error().line();
  ASSERT_EQ(table->rows.size(),
            34u);  // 14 parameters, 9 of ellipses, 2 antisymmetries, excess, and 2 for each of 4 arms
  for (const ValidationRow& row : table->rows) {
    // What is never said is never wrong: an arm that is well passive has to be recognised now and then.
    if (row.what.starts_with("passive arm called passive")) {
      EXPECT_GT(row.value, 40.0) << row.what;
    }
    EXPECT_EQ(row.judged(), !row.what.starts_with("passive")) << row.what;
    if (row.expected == kNominal) {
      EXPECT_NE(row.verdict(), RowVerdict::met) << row.what << ": 160 runs show no coverage";
    }
  }
  expect_nothing_refuted(*table);
}

TEST(Coverage, IsTheSameForTheSameSeedOnAnyNumberOfThreads) {
  const auto one = coverage({.runs = 6, .seed = 3, .threads = 1}), two = coverage({.runs = 6, .seed = 3, .threads = 2});
  ASSERT_TRUE(one && two);
  for (std::size_t k = 0; k < one->rows.size(); ++k) EXPECT_EQ(one->rows[k].value, two->rows[k].value);
}

TEST(Coverage, RefusesNoRuns) {
  EXPECT_FALSE(coverage({.runs = 0}));
}

}  // namespace
}  // namespace mbk::validation
