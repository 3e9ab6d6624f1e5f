#include "mbk/base/numeric/least_squares.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {
namespace {

Matrix noise(Index rows, Index columns, unsigned seed) {
  std::mt19937 random(seed);
  Matrix values(rows, columns);
  for (double& value : values.reshaped()) value = static_cast<double>(random()) / 4294967296.0 - 0.5;
  return values;
}

TEST(LeastSquares, ReturnsTheCoefficientsOfAnExactRelation) {
  Matrix Z = noise(500, 4, 1);
  Z.col(1) *= 1e6;  // columns of very different size, as ẍ and x are
  Z.col(2) *= 1e-4;
  Matrix truth = noise(4, 2, 2);  // each term contributes alike, as inertia and stiffness do
  truth.row(1) *= 1e-6;
  truth.row(2) *= 1e4;
  const auto fit = fit_least_squares(Z, Z * truth);
  ASSERT_TRUE(fit);
  for (Index j = 0; j < 4; ++j) EXPECT_TRUE(fit->coefficients.row(j).isApprox(truth.row(j), 1e-12));
  EXPECT_EQ(fit->rank, 4);
}

TEST(LeastSquares, SolvesItsNormalEquations) {
  const Matrix Z = noise(300, 5, 3), Y = noise(300, 2, 4);
  const auto fit = fit_least_squares(Z, Y);
  ASSERT_TRUE(fit);
  EXPECT_LT((Z.transpose() * (Y - Z * fit->coefficients)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE((fit->inverse_gram.topLeftCorner(5, 5)).isApprox(inverse(Z.transpose() * Z), 1e-10));
}

TEST(LeastSquares, ImposesAStructure) {
  // Two outputs that share one coefficient: y1 = a z1 + b z2, y2 = b z1 + c z2.
  const Matrix Z = noise(400, 2, 5), error = 0.1 * noise(400, 2, 6);
  Matrix truth(2, 2);
  truth << 1.0, -0.5, -0.5, 2.0;
  Matrix S = Matrix::Zero(4, 3);
  S(0, 0) = S(1, 1) = S(2, 1) = S(3, 2) = 1.0;
  const Matrix Y = Z * truth + error;
  const auto fit = fit_least_squares(Z, Y, S);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->coefficients(1, 0), fit->coefficients(0, 1));
  // The plain twin: stack the equations and solve them by normal equations.
  Matrix big = Matrix::Zero(800, 4);
  big.topLeftCorner(400, 2) = Z;
  big.bottomRightCorner(400, 2) = Z;
  const Matrix tied = big * S;
  Vector y(800);
  y << Y.col(0), Y.col(1);
  const Vector twin = PivotedCholesky(tied.transpose() * tied).solve(tied.transpose() * y);
  EXPECT_TRUE(fit->free.isApprox(twin, 1e-11));
}

TEST(LeastSquares, SeesColumnsThatCannotBeToldApart) {
  Matrix Z = noise(100, 3, 7);
  Z.col(2) = 2.0 * Z.col(0) - Z.col(1);
  const auto fit = fit_least_squares(Z, noise(100, 1, 8));
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->rank, 2);
  EXPECT_TRUE(std::isinf(fit->condition));
  EXPECT_TRUE(fit->coefficients.allFinite());
}

TEST(LeastSquares, RefusesTooFewRowsAndWhatIsNoNumber) {
  EXPECT_FALSE(fit_least_squares(noise(3, 4, 1), noise(3, 1, 1)));
  EXPECT_FALSE(fit_least_squares(noise(30, 4, 1), noise(29, 1, 1)));
  Matrix Z = noise(30, 4, 1);
  Z(17, 2) = std::numeric_limits<double>::quiet_NaN();
  const auto refused = fit_least_squares(Z, noise(30, 1, 1));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("row 17"));
}

/// The slow plain twin: Newey & West's double sum, term by term.
Matrix twin_newey_west(const LinearFit& fit, const Matrix& Z, const Matrix& e, const std::vector<RowRange>& ranges,
                       Index lags) {
  const Index p = Z.cols(), q = e.cols();
  const auto score = [&](Index t) {
    Vector s(p * q);
    for (Index j = 0; j < q; ++j) s.segment(j * p, p) = e(t, j) * Z.row(t).transpose();
    return Vector(fit.structure.transpose() * s);
  };
  Matrix omega = Matrix::Zero(fit.free.size(), fit.free.size());
  for (const RowRange& range : ranges) {
    for (Index t = range.begin; t < range.end; ++t) {
      for (Index u = range.begin; u < range.end; ++u) {
        const Index lag = std::abs(t - u);
        if (lag > lags) continue;
        omega += (1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1)) * score(t) * score(u).transpose();
      }
    }
  }
  return fit.inverse_gram * omega * fit.inverse_gram;
}

TEST(NeweyWest, AgreesWithTheDoubleSumAndStopsAtBreaks) {
  const Matrix Z = noise(220, 3, 9), Y = noise(220, 2, 10);
  Matrix S = Matrix::Zero(6, 5);
  S(0, 0) = S(1, 1) = S(2, 2) = S(3, 1) = S(4, 3) = S(5, 4) = 1.0;
  const std::vector<RowRange> ranges = {{0, 90}, {95, 100}, {100, 220}};
  for (const Matrix& structure : {Matrix(), S}) {
    const LinearFit fit = fit_least_squares(Z, Y, structure).value();
    const Matrix residuals = Y - Z * fit.coefficients;
    for (const Index lags : {0, 1, 12, 150}) {
      const Matrix V = newey_west_covariance(fit, Z, residuals, ranges, lags);
      EXPECT_TRUE(V.isApprox(twin_newey_west(fit, Z, residuals, ranges, lags), 1e-10)) << lags << " lags";
      EXPECT_TRUE(V.isApprox(V.transpose(), 1e-12));
    }
  }
}

TEST(NeweyWest, IsTheTextbookCovarianceForWhiteResiduals) {
  const Matrix Z = noise(20000, 2, 11), error = noise(20000, 1, 12);
  const LinearFit fit = fit_least_squares(Z, error).value();
  const Matrix residuals = error - Z * fit.coefficients;
  const Matrix V = newey_west_covariance(fit, Z, residuals, {{0, 20000}}, 0);
  const Matrix textbook = fit.inverse_gram * (residuals.squaredNorm() / 20000.0);
  EXPECT_TRUE(V.isApprox(textbook, 0.03));
}

TEST(NeweyWest, FittedWideningGivesBackWhatTheCoefficientsTook) {
  EXPECT_DOUBLE_EQ(fitted_widening(100.0, 7.0), std::sqrt(100.0 / 93.0));
  EXPECT_NEAR(fitted_widening(1e12, 7.0), 1.0, 1e-11);
  EXPECT_DOUBLE_EQ(fitted_widening(7.0, 7.0), std::sqrt(2.0));  // nothing is left: not infinite, but no interval
  // white residuals of a fit have (n − p)/n of the noise's variance in the mean
  constexpr int kRows = 12, kColumns = 3, kRuns = 20000;
  constexpr double kVariance = 1.0 / 12.0;
  double sum = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    const Matrix all = noise(kRows, kColumns + 1, run);
    const Matrix Z = all.leftCols(kColumns);
    const Vector y = all.col(kColumns);
    sum += (y - Z * PivotedCholesky(Z.transpose() * Z).solve(Z.transpose() * y)).squaredNorm() / (kRows * kVariance);
  }
  EXPECT_NEAR(std::sqrt(kRuns / sum), fitted_widening(kRows, kColumns), 0.01);
}

TEST(NeweyWest, WideningIsNoneForShortLagsAndTheFixedBLimitForLongOnes) {
  EXPECT_EQ(newey_west_widening(0.0), 1.0);
  EXPECT_NEAR(newey_west_widening(1.0) * 1.96, 4.813, 1e-3);  // Kiefer & Vogelsang 2005: 4.813 with all lags
  EXPECT_GT(newey_west_widening(0.1), newey_west_widening(0.05));
}

}  // namespace
}  // namespace mbk::numeric
