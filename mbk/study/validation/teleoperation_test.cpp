#include <gtest/gtest.h>

#include "mbk/study/validation/study.h"

namespace mbk::validation {
namespace {

TEST(TeleoperationStudy, FindsTheCriteriaAndTheSimulationsInAgreement) {
  const auto table = teleoperation_study({.runs = 3, .seed = 301});
  ASSERT_TRUE(table) << table.error().line();
  int judged = 0;
  for (const ValidationRow& row : table->rows) {
    EXPECT_TRUE(row.met()) << row.what << ": " << row.value;
    judged += row.judged() ? 1 : 0;
  }
  EXPECT_GE(judged, 8);
  ASSERT_EQ(table->charts.size(), 1u);
  EXPECT_EQ(table->charts[0].series.size(), 3u);
}

}  // namespace
}  // namespace mbk::validation
