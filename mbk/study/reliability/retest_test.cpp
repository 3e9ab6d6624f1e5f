#include "mbk/study/reliability/retest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace mbk::reliability {
namespace retest_test {

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

TEST(TestRetest, OfTheMeanIsNotAbove1WhereThatOfOneIsFarBelow0) {
  Matrix scores(5, 2);  // people alike, sessions alike, and each person up or down
  scores << 1, -1, -1, 1, 1, -1, -1, 1, 0.1, 0;
  const auto result = test_retest(scores);
  ASSERT_TRUE(result);
  ASSERT_LT(result->icc[1].value, -1.0);
  for (const Icc& icc : result->icc) {
    EXPECT_LE(icc.value, 1.0);
    EXPECT_LE(icc.interval95.first, icc.value);
    EXPECT_LE(icc.interval95.first, icc.interval95.second);
    EXPECT_LE(icc.interval95.second, 1.0);
  }
}

TEST(TestRetest, DoesNotSeeAShiftAndScalesItsErrorWithTheUnit) {
  const Matrix scores = shrout_and_fleiss();
  const auto one = test_retest(scores), other = test_retest((1000.0 * scores).array() + 1e7);
  ASSERT_TRUE(one && other);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(other->icc[i].value, one->icc[i].value, 1e-9);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(other->error[i].sem, 1000.0 * one->error[i].sem, 1e-6);
}

TEST(TestRetest, MeanSquaresAreThoseOfPlainSums) {
  const Matrix x = shrout_and_fleiss();
  const auto squares = mean_squares(x);
  ASSERT_TRUE(squares);
  double total = 0.0;
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 4; ++j) total += std::pow(x(i, j) - x.mean(), 2);
  }
  EXPECT_NEAR(5.0 * squares->between_people + 3.0 * squares->between_sessions + 15.0 * squares->residual, total, 1e-10);
  EXPECT_NEAR(5.0 * squares->between_people + 18.0 * squares->within_people, total, 1e-10);
  EXPECT_NEAR(squares->between_people, 11.24, 5e-3);  // Shrout & Fleiss (1979), table 3
  EXPECT_NEAR(squares->between_sessions, 32.49, 5e-3);
  EXPECT_NEAR(squares->residual, 1.02, 5e-3);
  EXPECT_NEAR(squares->within_people, 6.26, 5e-3);
}

TEST(TestRetest, IsOneWhereNothingButPeopleDiffer) {
  Matrix scores(6, 3);
  for (Index i = 0; i < 6; ++i) scores.row(i).setConstant(static_cast<double>(i));
  const auto result = test_retest(scores);
  ASSERT_TRUE(result);
  for (const Icc& icc : result->icc) {
    EXPECT_EQ(icc.value, 1.0);
    EXPECT_EQ(icc.interval95, Interval(1.0, 1.0));
  }
  EXPECT_EQ(result->error[0].sem, 0.0);
}

TEST(TestRetest, SaysWhatItLacks) {
  const Matrix scores = shrout_and_fleiss();
  EXPECT_EQ(test_retest(scores.topRows(4))->support, Support::too_few_people);
  EXPECT_TRUE(test_retest(scores.topRows(4))->icc.empty());
  EXPECT_EQ(test_retest(scores.leftCols(1))->support, Support::too_few_sessions);
  EXPECT_EQ(test_retest(Matrix::Constant(8, 3, 0.1))->support, Support::no_variation);
  EXPECT_FALSE(test_retest(Matrix()));
  Matrix missing = scores;
  missing(2, 1) = NAN;
  const auto refused = test_retest(missing);
  ASSERT_FALSE(refused);
  for (const char* const fact : {"person 3", "session 2"})
    EXPECT_NE(refused.error().message.find(fact), std::string::npos) << refused.error().message;
}

}  // namespace retest_test
}  // namespace mbk::reliability
