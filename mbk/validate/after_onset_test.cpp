#include <gtest/gtest.h>

#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace after_onset_test {

TEST(AfterOnsetStudy, RefutesNothingInARun) {
  const auto table = after_onset_study({.runs = 1, .seed = 5});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "after-onset");
  expect_nothing_refuted(*table);
}

}  // namespace after_onset_test
}  // namespace mbk::validation
