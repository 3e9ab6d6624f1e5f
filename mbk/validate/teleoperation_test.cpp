#include <gtest/gtest.h>

#include <algorithm>

#include "mbk/validate/study.h"
#include "mbk/validate/test_short_study.h"

namespace mbk::validation {
namespace {

TEST(TeleoperationStudy, FindsTheCriteriaAndTheSimulationsInAgreement) {
  const auto table = teleoperation_study({.runs = 3, .seed = 301});
  ASSERT_TRUE(table) << table.error().line();
  expect_nothing_refuted(*table);
  EXPECT_GE(std::ranges::count_if(table->rows, &ValidationRow::judged), 16);
  EXPECT_EQ(table->verdict(), RowVerdict::not_shown);  // no counterexample in so few designs says little
  ASSERT_EQ(table->charts.size(), 1u);
  EXPECT_EQ(table->charts[0].series.size(), 3u);
}

}  // namespace
}  // namespace mbk::validation
