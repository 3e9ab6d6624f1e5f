#include <gtest/gtest.h>

#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace reliability_recordings_test {

TEST(RecordedReliabilityStudy, RefutesNothingInTwoRuns) {
  const auto table = recorded_reliability_study({.runs = 2, .seed = 3});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "recorded-reliability");
  expect_nothing_refuted(*table);
  EXPECT_FALSE(recorded_reliability_study({.runs = 0}));
}

}  // namespace reliability_recordings_test
}  // namespace mbk::validation
