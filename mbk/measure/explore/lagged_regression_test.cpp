#include "mbk/measure/explore/lagged_regression.h"

#include <gtest/gtest.h>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/test_limb_trials.h"

namespace mbk::explore {
namespace lagged_regression_test {

TEST(Lagged, HasEachLagOfEachColumnInItsRow) {
  Matrix u(10, 2);
  for (Index i = 0; i < 10; ++i) u.row(i) << static_cast<double>(i), 100.0 + static_cast<double>(i);
  const Matrix columns = lagged(u, -1, 2, {{2, 4}, {7, 9}});
  Matrix expected(4, 8);
  expected << 3, 2, 1, 0, 103, 102, 101, 100,  //
      4, 3, 2, 1, 104, 103, 102, 101,          //
      8, 7, 6, 5, 108, 107, 106, 105,          //
      9, 8, 7, 6, 109, 108, 107, 106;
  EXPECT_EQ(columns, expected);
}

TEST(Lagged, KeepsAwayFromTheEndsOfAPiece) {
  const auto inside = rows_inside({{0, 50}, {60, 100}, {100, 103}}, {{0, 100}, {100, 103}}, 5, 2);
  ASSERT_EQ(inside.size(), 2u);
  EXPECT_EQ(inside[0].begin, 5);
  EXPECT_EQ(inside[0].end, 50);
  EXPECT_EQ(inside[1].begin, 60);
  EXPECT_EQ(inside[1].end, 98);
}

TEST(PrincipalDirections, LeaveOutWhatDoesNotVary) {
  Matrix X = white_noise(300, 3, 5);
  X.col(2) = 2.0 * X.col(0) - X.col(1);
  const Matrix V = principal_directions(X);
  ASSERT_EQ(V.cols(), 2);
  EXPECT_TRUE((V.transpose() * V).isIdentity(1e-12));
  const Vector spread = (X * V).colwise().norm();
  EXPECT_GT(spread[0], spread[1]);
}

TEST(CrossValidation, IsWhatFittingEachFoldByItselfGives) {
  const Matrix Z = centred(white_noise(400, 5, 1));
  Matrix Y = centred(white_noise(400, 2, 9));
  Y += Z.leftCols(2) * Matrix{{1.0, 0.3}, {-0.5, 2.0}};
  const Matrix errors = cross_validated_errors(Z, Y, 1, 4);
  ASSERT_EQ(errors.rows(), 4);
  ASSERT_EQ(errors.cols(), 5);
  for (Index fold = 0; fold < 4; ++fold) {
    for (Index r = 1; r <= 5; ++r) {
      Matrix others(300, r), of_others(300, 2);
      others << Z.topRows(100 * fold).leftCols(r), Z.bottomRows(300 - 100 * fold).leftCols(r);
      of_others << Y.topRows(100 * fold), Y.bottomRows(300 - 100 * fold);
      const Matrix left = Y.middleRows(100 * fold, 100) -
                          Z.middleRows(100 * fold, 100).leftCols(r) * numeric::householder_solve(others, of_others);
      double expected = 0.0;
      for (Index j = 0; j < 2; ++j) expected += left.col(j).squaredNorm() / Y.col(j).squaredNorm() * 400.0 / 200.0;
      EXPECT_NEAR(errors(fold, r - 1), expected, 1e-10);
    }
  }
}

TEST(FitLagged, HasTheErrorsThatRepetitionsHave) {
  constexpr Index kRows = 1500;
  constexpr int kRuns = 200;
  const Vector x = binary_motion(kRows + 4, 3);
  const std::vector<RowRange> rows = {{2, 700}, {700, kRows + 2}};
  const Matrix Z = centred(lagged(x, -1, 1, rows));
  Matrix found(kRuns, 3), errors(kRuns, 3);
  for (int run = 0; run < kRuns; ++run) {
    const Vector e = coloured_noise(Z.rows(), 100 + static_cast<std::uint64_t>(run));
    const LaggedFit fit = fit_lagged(Z, Z, centred(Z * Vector{{1.0, 2.0, 3.0}} + e), rows);
    found.row(run) = fit.coefficients.col(0).transpose();
    errors.row(run) = fit.covariance[0].diagonal().cwiseSqrt().transpose();
  }
  for (Index k = 0; k < 3; ++k) {
    const double spread = std::sqrt(numeric::variance(found.col(k)));
    constexpr double kFourErrors = 0.2;  // of a standard deviation from 200 runs
    EXPECT_NEAR(errors.col(k).mean() / spread, 1.0, kFourErrors);
    EXPECT_NEAR(found.col(k).mean(), static_cast<double>(k + 1), 4.0 * spread / std::sqrt(kRuns));
  }
}

TEST(FitLagged, IsNotBiasedWhereInstrumentsHoldNoNoise) {
  constexpr Index kRows = 20000;
  const Vector r = white_noise(kRows, 1), w = white_noise(kRows, 2);
  const Matrix Z = centred(r + w), R = centred(r), Y = centred(3.0 * (r + w) - 2.0 * w);
  const std::vector<RowRange> rows = {{0, kRows}};
  EXPECT_NEAR(fit_lagged(Z, R, Y, rows).coefficients(0, 0), 3.0, 0.06);
  EXPECT_NEAR(fit_lagged(Z, Z, Y, rows).coefficients(0, 0), 2.0, 0.06);
}

TEST(Whitening, IsTheDifferenceEquationAndLosesTheFirstRowsOfEachRange) {
  const Vector y{{1, 2, 4, 8, 16, 3, 5, 7}};
  const Matrix white = whitened(y, Vector{{1.0, -2.0}}, {{10, 15}, {20, 23}});
  EXPECT_EQ(white, (Matrix{{0.0}, {0.0}, {0.0}, {0.0}, {-1.0}, {-3.0}}));
}

TEST(AccountedFor, IsTheVarianceWithAnIntervalThatHoldsIt) {
  constexpr int kRuns = 200;
  constexpr Index kRows = 2000;
  int held = 0;
  for (int run = 0; run < kRuns; ++run) {
    const Vector signal = coloured_noise(kRows, 10 + static_cast<std::uint64_t>(run));
    const Vector e = 0.5 * coloured_noise(kRows, 1000 + static_cast<std::uint64_t>(run));
    const AccountedFor found = accounted_for(signal + e, e, {{0, kRows}}, kStep);
    EXPECT_NEAR(found.percent, numeric::variance_accounted_for(signal + e, e), 1e-10);
    held += std::abs(found.percent - 80.0) <= found.half_width ? 1 : 0;
  }
  EXPECT_GE(held, 176);  // 88 %: four standard errors under 95 %
}

}  // namespace lagged_regression_test
}  // namespace mbk::explore
