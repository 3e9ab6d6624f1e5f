#include <gtest/gtest.h>

#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace emg_test {

TEST(EmgStudy, RefutesNothingInAFewRuns) {
  const auto table = emg_study({.runs = 60, .seed = 5});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "emg");
  expect_nothing_refuted(*table);
}

}  // namespace emg_test
}  // namespace mbk::validation
