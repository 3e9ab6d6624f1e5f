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

TEST(Folds, HoldEachRowOnceAndInOrder) {
  const auto folds = folds_of({{3, 10}, {20, 22}, {30, 38}}, 4);
  std::vector<Index> rows;
  for (const auto& fold : folds) {
    EXPECT_NEAR(static_cast<double>(row_count(fold)), 17.0 / 4.0, 1.0);
    for (const RowRange& range : fold) {
      for (Index row = range.begin; row < range.end; ++row) rows.push_back(row);
    }
  }
  EXPECT_EQ(rows, (std::vector<Index>{3, 4, 5, 6, 7, 8, 9, 20, 21, 30, 31, 32, 33, 34, 35, 36, 37}));
}

TEST(LaggedMoments, AreThoseOfTheRowsThemselves) {
  const Matrix u = white_noise(200, 2, 1).array() + 0.7, v = white_noise(200, 1, 5).cwiseAbs();
  const Matrix Y = white_noise(200, 2, 9).array() - 0.4;
  const std::vector<RowRange> ranges = {{10, 60}, {75, 76}, {90, 190}};
  const auto folds = folds_of(ranges, 3);
  Matrix Z(row_count(ranges), 2 * 5 + 7);
  Z << lagged(u, -2, 2, ranges), lagged(v, 3, 9, ranges);
  Z = centred(Z);
  const Matrix outputs = centred(rows_of(Y, ranges));
  const auto found = lagged_moments({{u, -2, 2}, {v, 3, 9}}, Y, folds);
  ASSERT_EQ(found.size(), 3u);
  Index at = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Index rows = row_count(folds[k]);
    const Matrix part = Z.middleRows(at, rows), output = outputs.middleRows(at, rows);
    EXPECT_EQ(found[k].rows, rows);
    EXPECT_LT((found[k].ZZ - part.transpose() * part).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT((found[k].ZY - part.transpose() * output).cwiseAbs().maxCoeff(), 1e-11);
    EXPECT_LT((found[k].YY - output.colwise().squaredNorm().transpose()).cwiseAbs().maxCoeff(), 1e-11);
    at += rows;
  }
  const Matrix V = white_noise(17, 4, 20);
  const Matrix turned = Z.topRows(row_count(folds[0])) * V;
  EXPECT_LT((in_directions(found, V)[0].ZZ - turned.transpose() * turned).cwiseAbs().maxCoeff(), 1e-9);
  const Matrix first = white_noise(10, 3, 40);
  Matrix partly(row_count(folds[0]), 3 + 7);
  partly << Z.topRows(row_count(folds[0])).leftCols(10) * first, Z.topRows(row_count(folds[0])).rightCols(7);
  const auto turned_partly = in_directions(found, first);
  EXPECT_LT((turned_partly[0].ZZ - partly.transpose() * partly).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((turned_partly[0].ZY - partly.transpose() * outputs.topRows(row_count(folds[0]))).cwiseAbs().maxCoeff(),
            1e-9);
  const auto kept = of_columns(found, {12, 3});
  EXPECT_EQ(kept[1].ZZ(0, 1), found[1].ZZ(12, 3));
  EXPECT_EQ(kept[1].ZY(1, 0), found[1].ZY(3, 0));
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
