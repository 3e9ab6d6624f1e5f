#include <gtest/gtest.h>

#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace change_test {

TEST(ChangeStudy, RefutesNothingInAFewRuns) {
  const auto table = change_study({.runs = 2, .seed = 5});
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->study, "change");
  expect_nothing_refuted(*table);
}

}  // namespace change_test
}  // namespace mbk::validation
