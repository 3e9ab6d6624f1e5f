#include <gtest/gtest.h>

#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace reliability_study_test {

TEST(ReliabilityStudy, RefutesNothingInSixtyRuns) {
  const auto table = reliability_study({.runs = 60, .seed = 5});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "reliability");
  expect_nothing_refuted(*table);
}

}  // namespace reliability_study_test
}  // namespace mbk::validation
