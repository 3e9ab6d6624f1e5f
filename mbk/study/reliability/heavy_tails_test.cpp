#include "mbk/study/reliability/heavy_tails.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/numeric/random.h"
#include "mbk/study/reliability/retest.h"

namespace mbk::reliability {
namespace heavy_tails_test {

template <class Draw>
Matrix drawn(Index people, Index sessions, numeric::Random& random, Draw error) {
  Matrix scores(people, sessions);
  for (Index i = 0; i < people; ++i) {
    const double own = 300.0 + 60.0 * random.normal();
    for (Index j = 0; j < sessions; ++j) scores(i, j) = own + 5.0 * static_cast<double>(j) + 20.0 * error();
  }
  return scores;
}

TEST(TailTest, IsOfTheResidualsAlone) {
  numeric::Random random(3);
  const Matrix scores = drawn(12, 3, random, [&] { return random.normal(); });
  Matrix moved = 7.0 * scores;
  moved.colwise() += Vector::LinSpaced(12, -1e4, 3e4);
  moved.rowwise() += Eigen::RowVector3d(100.0, -50.0, 0.0);
  EXPECT_NEAR(tail_test(moved).kurtosis, tail_test(scores).kurtosis, 1e-6);
  EXPECT_EQ(tail_test(moved).p, tail_test(scores).p);
}

TEST(TailTest, NamesTheLargestResidual) {
  numeric::Random random(4);
  Matrix scores = drawn(12, 3, random, [&] { return random.normal(); });
  scores(7, 2) += 400.0;
  const TailTest test = tail_test(scores);
  EXPECT_LT(test.p, 0.001);
  EXPECT_EQ(test.row, 7);
  EXPECT_EQ(test.column, 2);
}

TEST(TailTest, OfTooLittleOrOfNothingIsNotMade) {
  EXPECT_EQ(tail_test(Matrix::Random(4, 3)).p, 1.0);
  EXPECT_EQ(tail_test(Matrix::Random(9, 1)).p, 1.0);
  EXPECT_EQ(tail_test(Matrix::Constant(9, 3, 1e9)).p, 1.0);
  EXPECT_EQ(tail_test(Vector::LinSpaced(9, 0.0, 1.0) * Eigen::RowVector2d(1.0, 1.0)).p, 1.0);
}

TEST(TailTest, OfNormalErrorsIsCalibratedAtEverySize) {
  for (const auto& [people, sessions] : {std::pair<Index, Index>{6, 2}, {12, 3}, {9000, 3}}) {
    numeric::Random random(5);
    int small = 0;
    const int runs = people > 1000 ? 100 : 1000;
    for (int k = 0; k < runs; ++k) {
      small +=
          tail_test(drawn(people, sessions, random, [&] { return random.normal(); })).p <= kTailFalseAlarms ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(small) / runs, 0.04, people > 1000 ? 0.06 : 0.02) << people;
  }
}

/// The interval of MDC holds the truth or the test is significant; `mbk validate reliability` counts it in thousands.
TEST(TailTest, OrTheIntervalOfMdcHoldsUnderHeavyTails) {
  numeric::Random random(6);
  const auto student3 = [&] {
    double squares = 0.0;
    const double z = random.normal();
    for (int k = 0; k < 3; ++k) squares += std::pow(random.normal(), 2);
    return z / std::sqrt(squares);  // variance 1
  };
  const auto outliers = [&] { return random.normal() + (random.uniform() < 0.03 ? 5.0 : 0.0); };
  constexpr int kRuns = 300;
  const double change = 1.96 * std::sqrt(2.0) * 20.0;
  int normal = 0, of_student = 0, of_outliers = 0;
  for (int k = 0; k < kRuns; ++k) {
    const auto fine = [&](const Matrix& scores, double mdc) {
      const auto [low, high] = test_retest(scores)->error[1].mdc95_interval;
      return (low <= mdc && mdc <= high) || tail_test(scores).p <= kTailFalseAlarms;
    };
    normal += tail_test(drawn(12, 2, random, [&] { return random.normal(); })).p <= kTailFalseAlarms ? 1 : 0;
    of_student += fine(drawn(12, 2, random, student3), change) ? 1 : 0;
    of_outliers += fine(drawn(12, 2, random, outliers), change * std::sqrt(1.0 + 0.03 * 0.97 * 25.0)) ? 1 : 0;
  }
  EXPECT_LE(normal, kRuns * 7 / 100);
  EXPECT_GE(of_student, kRuns * 9 / 10);
  EXPECT_GE(of_outliers, kRuns * 9 / 10);
}

TEST(WidenedForTails, KeepsTheEstimateAndTheEndsThatAreNone) {
  const auto [low, high] = widened_for_tails(2.0, {1.0, 4.0});
  EXPECT_NEAR(low, 2.0 * std::pow(0.5, std::sqrt(2.5)), 1e-12);
  EXPECT_NEAR(low * high, 4.0, 1e-12);
  EXPECT_EQ(widened_for_tails(2.0, {0.0, INFINITY}).first, 0.0);
  EXPECT_EQ(widened_for_tails(2.0, {0.0, INFINITY}).second, INFINITY);
  EXPECT_EQ(widened_for_tails(0.0, {0.0, 1.0}).second, 1.0);
}

}  // namespace heavy_tails_test
}  // namespace mbk::reliability
