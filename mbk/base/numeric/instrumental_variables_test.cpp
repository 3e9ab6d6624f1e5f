#include "mbk/base/numeric/instrumental_variables.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"

namespace mbk::numeric {
namespace instrumental_variables_test {

/// x_t = c x_{t−1} + √(1 − c²) w_t, of variance 1.
Vector first_order(Random& random, Index rows, double correlation) {
  Vector noise(rows);
  double value = random.normal();
  for (Index i = 0; i < rows; ++i) {
    noise[i] = value;
    value = correlation * value + std::sqrt(1.0 - correlation * correlation) * random.normal();
  }
  return noise;
}

/// Two regressors of very different size that share the noise e with both outputs, and the constant.
struct Data {
  Matrix Z, R, E;
  Matrix theta{{2e-3, -1e-3}, {300.0, 70.0}, {4.0, -5.0}};
  explicit Data(Index rows, std::uint64_t seed = 1, double correlation = 0.9) {
    Random random(seed);
    R.setOnes(rows, 3);
    R.col(0) = 1e3 * first_order(random, rows, correlation);
    R.col(1) = 1e-2 * first_order(random, rows, correlation);
    E.resize(rows, 2);
    for (Index j = 0; j < 2; ++j) E.col(j) = first_order(random, rows, correlation);
    Z = R;
    Z.col(0) += 2.0 * R.col(1) * 1e5 - 500.0 * E.col(0);
    Z.col(1) += 0.005 * (E.col(0) + E.col(1));
  }
  [[nodiscard]] Matrix outputs(double noise) const { return Z * theta + noise * E; }
};

/// Third coefficients tied: θ₃₂ = −θ₃₁·5/4, and all else free.
Matrix tied() {
  Matrix S = Matrix::Zero(6, 5);
  S(0, 0) = S(1, 1) = S(2, 2) = S(3, 3) = S(4, 4) = 1.0;
  S(5, 2) = -1.25;
  return S;
}

double scaled_difference(const Matrix& got, const Matrix& expected) {
  return ((got - expected).array() / expected.array()).abs().maxCoeff();
}

constexpr double kRounding = 1e-10;  // condition of the scaled moments, about 10, times ε, and room

TEST(InstrumentalVariables, AreExactWithoutNoise) {
  const Data data(300);
  const auto free = fit_instrumental_variables(data.Z, data.R, data.outputs(0.0));
  const auto bound = fit_instrumental_variables(data.Z, data.R, data.outputs(0.0), tied());
  ASSERT_TRUE(free && bound);
  EXPECT_EQ(free->rank, 3);
  EXPECT_LT(scaled_difference(free->coefficients, data.theta), kRounding);
  EXPECT_LT(scaled_difference(bound->coefficients, data.theta), kRounding);
  EXPECT_EQ(bound->free.size(), 5);
}

TEST(InstrumentalVariables, AreTheSameFromProductsThatAreThere) {
  const Data data(300);
  const Matrix Y = data.outputs(1.0);
  for (const Matrix& S : {Matrix(), tied()}) {
    const auto by_rows = fit_instrumental_variables(data.Z, data.R, Y, S);
    const auto by_products = fit_instrumental_variables(gram_of({data.R, data.Z, Y}), 3, 300, S);
    ASSERT_TRUE(by_rows && by_products);
    EXPECT_EQ(by_rows->coefficients, by_products->coefficients);
    EXPECT_EQ(by_rows->inverse, by_products->inverse);
  }
  const Matrix both = gram_of({data.R, data.Z});
  const std::vector<RowRange> all = {{0, 300}};
  EXPECT_EQ(first_stage_strength(data.Z, data.R, all, 5, both), first_stage_strength(data.Z, data.R, all, 5));
}

TEST(InstrumentalVariables, SolveTheirEquationsTiedAndFree) {
  const Data data(300);
  const Matrix Y = data.outputs(2.0);
  const Matrix A = data.R.transpose() * data.Z;
  Matrix both = Matrix::Zero(6, 6);
  both.topLeftCorner(3, 3) = both.bottomRightCorner(3, 3) = A;
  for (const Matrix& S : {Matrix(Matrix::Identity(6, 6)), tied()}) {
    const auto fit = fit_instrumental_variables(data.Z, data.R, Y, S);
    ASSERT_TRUE(fit);
    const Matrix system = S.transpose() * both * S;
    const Vector phi = FullyPivotedLu(system).solve(S.transpose() * Vector((data.R.transpose() * Y).reshaped()));
    EXPECT_LT(scaled_difference(fit->free, phi), 1e-8);  // the plain twin is not scaled
    EXPECT_LT(scaled_difference(Vector(fit->coefficients.reshaped()), S * phi), 1e-8);
    EXPECT_LT((fit->inverse * system - Matrix::Identity(S.cols(), S.cols())).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_LT(scaled_difference(fit->inverse * system * phi, phi), 1e-8);
  }
}

// u = r − f y, y = g u + v: least squares tends to (g σ_r² − f σ_v²)/(σ_r² + f² σ_v²), for a quiet reference to −1/f,
// minus the controller. Söderström & Stoica 1989, section 10.
TEST(InstrumentalVariables, FindThePlantInALoopWhereLeastSquaresFindsTheController) {
  constexpr double kPlant = 0.7, kFeedback = 2.0;
  constexpr Index kRows = 40'000;
  for (const double reference : {2.0, 0.5}) {
    SCOPED_TRACE(reference);
    Random random(3);
    Matrix U = Matrix::Ones(kRows, 2), R = U, Y(kRows, 1);
    for (Index i = 0; i < kRows; ++i) {
      const double r = reference * random.normal(), v = random.normal();
      U(i, 0) = (r - kFeedback * v) / (1.0 + kFeedback * kPlant);
      Y(i, 0) = kPlant * U(i, 0) + v;
      R(i, 0) = r;
    }
    const double power = reference * reference + kFeedback * kFeedback;
    const double limit = (kPlant * reference * reference - kFeedback) / power;
    const auto ls = fit_least_squares(U, Y);
    const auto iv = fit_instrumental_variables(U, R, Y);
    ASSERT_TRUE(ls && iv);
    // Deviation of both: σ_v (1 + f g)/(√N σ_r) for the instruments, and less for least squares.
    const double deviation = (1.0 + kFeedback * kPlant) / (std::sqrt(kRows) * reference);
    EXPECT_NEAR(iv->coefficients(0, 0), kPlant, 4.0 * deviation);
    EXPECT_NEAR(ls->coefficients(0, 0), limit, 4.0 * deviation);
    EXPECT_GT(std::abs(limit - kPlant), 10.0 * deviation);
    const Matrix left = Y - U * iv->coefficients;
    const double error = std::sqrt(newey_west_covariance(*iv, R, left, {{0, kRows}}, 0)(0, 0));
    EXPECT_NEAR(error, deviation, 0.15 * deviation);  // E[ur] and the residual are known to 2 % each, and not apart
  }
}

TEST(InstrumentalVariables, WithTheRegressorsThemselvesAreLeastSquares) {
  const Data data(400);
  const Matrix Y = data.outputs(2.0);
  for (const Matrix& S : {Matrix(), tied()}) {
    const auto ls = fit_least_squares(data.Z, Y, S);
    const auto iv = fit_instrumental_variables(data.Z, data.Z, Y, S);
    ASSERT_TRUE(ls && iv);
    EXPECT_LT(scaled_difference(iv->coefficients, ls->coefficients), kRounding);
    EXPECT_LT(scaled_difference(iv->inverse.diagonal(), ls->inverse_gram.diagonal()), kRounding);
    const Matrix left = Y - data.Z * ls->coefficients;
    const std::vector<RowRange> ranges = {{0, 150}, {170, 400}};
    const Matrix expected = newey_west_covariance(*ls, data.Z, left, ranges, 20);
    const Matrix got = newey_west_covariance(*iv, data.Z, left, ranges, 20);
    const Vector scale = expected.diagonal().cwiseSqrt().cwiseInverse();
    EXPECT_LT((scale.asDiagonal() * (got - expected) * scale.asDiagonal()).cwiseAbs().maxCoeff(), kRounding);
  }
}

TEST(InstrumentalVariables, HaveTheCovarianceOfManyExperiments) {
  // Of 400 experiments the spread of a variance is √(2/400) = 7 %; lags of 100 rows keep 0.9^|l| but for 10 % of it.
  constexpr int kExperiments = 400;
  constexpr Index kRows = 2000, kLags = 100;
  const Matrix S = tied();
  Matrix found(5, kExperiments), claimed = Matrix::Zero(5, 5), naive = claimed;
  for (int k = 0; k < kExperiments; ++k) {
    const Data data(kRows, static_cast<std::uint64_t>(100 + k));
    const Matrix Y = data.outputs(1.0);
    const auto fit = fit_instrumental_variables(data.Z, data.R, Y, S);
    ASSERT_TRUE(fit);
    found.col(k) = fit->free;
    const Matrix left = Y - data.Z * fit->coefficients;
    claimed += newey_west_covariance(*fit, data.R, left, {{0, kRows}}, kLags) / kExperiments;
    naive += newey_west_covariance(*fit, data.R, left, {{0, kRows}}, 0) / kExperiments;
  }
  const Vector truth{{2e-3, 300.0, 4.0, -1e-3, 70.0}};
  const Matrix about = found.colwise() - found.rowwise().mean();
  const Matrix sample = about * about.transpose() / (kExperiments - 1);
  for (Index i = 0; i < 5; ++i) {
    const double deviation = std::sqrt(sample(i, i));
    EXPECT_NEAR(found.row(i).mean(), truth[i], 4.0 * deviation / std::sqrt(kExperiments)) << i;
    EXPECT_NEAR(claimed(i, i) / sample(i, i), 0.92, 0.25) << i;
    EXPECT_LT(naive(i, i), 0.4 * sample(i, i)) << i;
    for (Index j = 0; j < i; ++j) {
      EXPECT_NEAR(claimed(i, j) / std::sqrt(claimed(i, i) * claimed(j, j)),
                  sample(i, j) / std::sqrt(sample(i, i) * sample(j, j)), 0.2)
          << i << " " << j;
    }
  }
}

TEST(InstrumentalVariables, ThatCannotTellTheTermsApartGiveNoNumber) {
  Data data(200);
  const Matrix Y = data.outputs(1.0);
  Matrix twice = data.R, none = data.R;
  twice.col(1) = 3.0 * twice.col(0);
  none.col(1).setZero();
  for (const Matrix& R : {twice, none}) {
    const auto fit = fit_instrumental_variables(data.Z, R, Y, tied());
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->rank, 2);
    EXPECT_TRUE(fit->coefficients.array().isNaN().all());
    EXPECT_TRUE(fit->free.array().isNaN().all());
    EXPECT_TRUE(fit->inverse.array().isNaN().all());
    EXPECT_EQ(fit->inverse.rows(), 5);
  }
}

TEST(InstrumentalVariables, RefuseWhatDoesNotGoTogether) {
  const Data data(20);
  const Matrix Y = data.outputs(1.0);
  EXPECT_FALSE(fit_instrumental_variables(data.Z, data.R.leftCols(2), Y));
  EXPECT_FALSE(fit_instrumental_variables(data.Z, data.R.topRows(19), Y));
  EXPECT_FALSE(fit_instrumental_variables(data.Z, data.R, Y.topRows(19)));
  EXPECT_FALSE(fit_instrumental_variables(data.Z.topRows(2), data.R.topRows(2), Y.topRows(2)));
  EXPECT_FALSE(fit_instrumental_variables(Matrix(0, 3), Matrix(0, 3), Matrix(0, 2)));
  const Matrix gram = gram_of({data.R, data.Z, Y});
  EXPECT_FALSE(fit_instrumental_variables(gram, 4, 20));             // no outputs
  EXPECT_FALSE(fit_instrumental_variables(gram, 3, 2));              // too few samples
  EXPECT_FALSE(fit_instrumental_variables(gram.topRows(7), 3, 20));  // not square
  for (int k = 0; k < 3; ++k) {
    Matrix Z = data.Z, R = data.R, outputs = Y;
    (k == 0 ? Z : k == 1 ? R : outputs)(7, 1) = kNaN;
    EXPECT_FALSE(fit_instrumental_variables(Z, R, outputs)) << k;
  }
}

/// Sanderson & Windmeijer's statistic for residuals of one variance: two-stage least squares of z_j on the others, and
/// the textbook F of what is left on the instruments.
double plain_strength(const Matrix& Z, const Matrix& R, Index j) {
  const Index m = Z.cols() - 1, excluded = R.cols() - 1, rows = Z.rows();
  Matrix others(rows, m);
  for (Index i = 0, k = 0; i <= m; ++i) {
    if (i != j) others.col(k++) = Z.col(i);
  }
  const auto projected = [&](const Matrix& Y) { return Matrix(R * PivotedQr(R).solve(Y)); };
  const Vector own = Z.col(j) - others * PivotedQr(projected(others)).solve(Z.col(j));
  const Vector left = own - projected(own);
  const double explained = (own.array() - own.mean()).square().sum() - left.squaredNorm();
  return explained / static_cast<double>(excluded - m + 1) /
         (left.squaredNorm() / static_cast<double>(rows - R.cols()));
}

/// z₁ and z₂ on three instruments by these coefficients, with noise of variance 1.
struct FirstStage {
  Matrix Z, R;
  FirstStage(Index rows, const Matrix& coefficients, double correlation, std::uint64_t seed) {
    Random random(seed);
    R.setOnes(rows, coefficients.rows() + 1);
    for (Index j = 0; j < coefficients.rows(); ++j) R.col(j) = first_order(random, rows, correlation);
    Z.setOnes(rows, 3);
    Z.leftCols(2) = R.leftCols(coefficients.rows()) * coefficients;
    for (Index j = 0; j < 2; ++j) Z.col(j) += first_order(random, rows, correlation);
    Z.col(0) *= 1e4;
  }
};

TEST(FirstStageStrength, IsTheConditionalFWhereResidualsAreWhite) {
  // The Wald statistic by the sandwich differs from the textbook's by the sampling of fourth moments: √(24/N) = 5 %,
  // and by what 10 instead of 0 lags add, much the same.
  constexpr Index kRows = 10'000;
  const Matrix coefficients{{0.5, 0.1}, {0.2, 0.4}, {-0.1, 0.3}};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const Index instruments : {2, 3}) {
      const FirstStage data(kRows, coefficients.topRows(instruments), 0.0, seed);
      const Vector strength = first_stage_strength(data.Z, data.R, {{0, kRows}}, 0);
      ASSERT_EQ(strength.size(), 2);
      for (Index j = 0; j < 2; ++j) {
        const double expected = plain_strength(data.Z, data.R, j);
        EXPECT_GT(expected, 100.0);
        EXPECT_NEAR(strength[j] / expected, 1.0, 0.15) << "seed " << seed << ", " << instruments << ", " << j;
      }
    }
  }
}

TEST(FirstStageStrength, IsNotTakenInByColouredNoise) {
  // Instruments that have nothing to do with the regressors: F is 1 on average, and above 10 hardly ever. As if rows
  // were independent it would be some 19 times that.
  const Matrix none = Matrix::Zero(3, 2);
  double mean = 0.0, plain = 0.0;
  constexpr int kTrials = 60;
  for (int k = 0; k < kTrials; ++k) {
    const FirstStage data(2000, none, 0.95, static_cast<std::uint64_t>(k + 1));
    const Vector strength = first_stage_strength(data.Z, data.R, {{0, 2000}}, 100);
    mean += strength.mean() / kTrials;
    plain += plain_strength(data.Z, data.R, 0) / kTrials;
  }
  EXPECT_LT(mean, 4.0);
  EXPECT_GT(plain, 8.0);
}

TEST(FirstStageStrength, IsBelowTenWhereOneInstrumentServesTwoRegressors) {
  Matrix same{{1.0, 0.5}, {0.0, 0.0}};
  const FirstStage data(4000, same, 0.0, 5);
  const Vector strength = first_stage_strength(data.Z, data.R, {{0, 4000}}, 0);
  EXPECT_LT(strength.maxCoeff(), 10.0);
  // Each regressor by itself follows that instrument closely.
  Matrix Z(4000, 2);
  Z << data.Z.col(0), data.Z.col(2);
  EXPECT_GT(first_stage_strength(Z, data.R, {{0, 4000}}, 0)[0], 1000.0);
}

TEST(FirstStageStrength, IsNoneWhereInstrumentsAreMissing) {
  FirstStage data(500, Matrix{{0.5, 0.1}, {0.2, 0.4}}, 0.0, 6);
  data.R.col(1) = -2.0 * data.R.col(0);
  EXPECT_EQ(first_stage_strength(data.Z, data.R, {{0, 500}}, 5), Vector::Zero(2));
  data.R.col(1).setZero();
  EXPECT_EQ(first_stage_strength(data.Z, data.R, {{0, 500}}, 5), Vector::Zero(2));
}

TEST(FirstStageStrength, IsNoneWhereEachRegressorStandsTwice) {
  const FirstStage data(500, Matrix::Random(5, 2), 0.0, 7);
  Matrix Z(500, 5);
  Z << data.Z.col(0), data.Z.col(0), data.Z.col(1), data.Z.col(1), data.Z.col(2);
  EXPECT_EQ(first_stage_strength(Z, data.R, {{0, 500}}, 5), Vector::Zero(4));
}

TEST(FirstStageStrength, GrowsWithTheShareThatTheInstrumentsExplain) {
  double before = 0.0;
  for (const double slope : {0.02, 0.1, 0.5, 2.0}) {
    const FirstStage data(2000, slope * Matrix::Identity(2, 2), 0.0, 7);
    const double strength = first_stage_strength(data.Z, data.R, {{0, 2000}}, 0).minCoeff();
    EXPECT_GT(strength, before);
    EXPECT_EQ(strength > 10.0, slope > 0.05);
    before = strength;
  }
  EXPECT_GT(before, 1000.0);
}

}  // namespace instrumental_variables_test
}  // namespace mbk::numeric
