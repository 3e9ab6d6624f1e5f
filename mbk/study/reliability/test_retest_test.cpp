#include "mbk/study/reliability/test_retest.h"

#include <gtest/gtest.h>

namespace mbk::reliability {
namespace test_retest_test {

/// Shrout & Fleiss (1979), table 2: six people, four judges.
Matrix shrout_and_fleiss() {
  return Matrix{{9, 2, 5, 8}, {6, 1, 3, 2}, {8, 4, 6, 8}, {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
}

constexpr double kPrinted = 1e-6;  // six digits of the reference

TEST(TestRetest, GivesTheNumbersOfShroutAndFleiss) {
  const auto result = test_retest(shrout_and_fleiss());
  ASSERT_TRUE(result) << result.error().line();
  ASSERT_EQ(result->support, Support::enough);
  ASSERT_EQ(result->icc.size(), 6U);
  const double values[] = {0.165742, 0.289764, 0.714841, 0.442797, 0.620051, 0.909316};
  const IccForm forms[] = {IccForm::one_way, IccForm::agreement, IccForm::consistency};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(result->icc[i].value, values[i], kPrinted);
    EXPECT_EQ(result->icc[i].form, forms[i % 3]);
    EXPECT_EQ(result->icc[i].averaged, i < 3 ? 1 : 4);
  }
  const Interval intervals[] = {{-0.132932, 0.722560}, {0.018787, 0.761084}, {0.342465, 0.945858}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(result->icc[i].interval95.first, intervals[i].first, kPrinted);
    EXPECT_NEAR(result->icc[i].interval95.second, intervals[i].second, kPrinted);
  }
  ASSERT_EQ(result->error.size(), 2U);
  EXPECT_EQ(result->error[0].form, IccForm::agreement);
  EXPECT_NEAR(result->error[0].sem, 2.502776, kPrinted);
  EXPECT_NEAR(result->error[0].mdc95, 6.937342, kPrinted);
  EXPECT_EQ(result->error[1].form, IccForm::consistency);
  EXPECT_NEAR(result->error[1].sem, 1.009675, kPrinted);
  EXPECT_NEAR(result->error[1].mdc95, 2.798677, kPrinted);
}

}  // namespace test_retest_test
}  // namespace mbk::reliability
