#include "mbk/base/numeric/block_bootstrap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::numeric {
namespace block_bootstrap_test {

/// Columns of x_t = φ x_{t−1} + √(1 − φ²) w_t, of variance 1.
Matrix first_order_noise(Random& random, Index rows, Index columns, double correlation) {
  Matrix noise(rows, columns);
  for (Index j = 0; j < columns; ++j) {
    double value = random.normal();
    for (Index i = 0; i < rows; ++i) {
      noise(i, j) = value;
      value = correlation * value + std::sqrt(1.0 - correlation * correlation) * random.normal();
    }
  }
  return noise;
}

Matrix rows_of(const Matrix& all, const std::vector<RowRange>& ranges) {
  Index count = 0;
  for (const RowRange& range : ranges) count += range.size();
  Matrix rows(count, all.cols());
  Index row = 0;
  for (const RowRange& range : ranges) {
    rows.middleRows(row, range.size()) = all.middleRows(range.begin, range.size());
    row += range.size();
  }
  return rows;
}

/// Two outputs on three regressors of very different size.
struct Data {
  Matrix Z, R, Y;
  explicit Data(Index rows, unsigned seed = 1) {
    Random random(seed);
    R = first_order_noise(random, rows, 3, 0.9);
    Z = R + 0.5 * first_order_noise(random, rows, 3, 0.5);
    Z.col(0) *= 1e4;
    Z.col(2) *= 1e-3;
    const Matrix theta{{1e-4, 2e-4}, {3.0, -1.0}, {500.0, 2000.0}};
    Y = Z * theta + 0.5 * first_order_noise(random, rows, 2, 0.8);
  }
};

const std::vector<RowRange> kRanges = {{3, 400}, {400, 430}, {450, 980}};

TEST(BlockBootstrap, AgreesWithStackingTheDrawnRowsAndSolving) {
  const Data data(1000);
  const BlockBootstrapOptions options{.block_rows = 60, .replicates = 50, .seed = 7};
  const auto ls = block_bootstrap(data.Z, data.Z, data.Y, {}, kRanges, options);
  const auto iv = block_bootstrap(data.Z, data.R, data.Y, {}, kRanges, options);
  Matrix S = Matrix::Zero(6, 5);  // the third coefficients of both outputs are one
  S(0, 0) = S(1, 1) = S(2, 2) = S(3, 3) = S(4, 4) = S(5, 2) = 1.0;
  const auto tied = block_bootstrap(data.Z, data.Z, data.Y, S, kRanges, options);
  ASSERT_TRUE(ls && iv && tied);
  const auto resampler = BlockResampler::make(data.Z, data.Z, data.Y, kRanges, 60);
  ASSERT_TRUE(resampler);
  constexpr double kRounding = 1e-10;
  for (int i = 0; i < options.replicates; ++i) {
    const auto rows = resampler->draw(7, static_cast<std::uint32_t>(i));
    const Matrix Z = rows_of(data.Z, rows), R = rows_of(data.R, rows), Y = rows_of(data.Y, rows);
    EXPECT_TRUE(ls->coefficients.col(i).isApprox(householder_solve(Z, Y).reshaped(), kRounding)) << i;
    const Matrix slow = FullyPivotedLu(R.transpose() * Z).solve(R.transpose() * Y);
    EXPECT_TRUE(iv->coefficients.col(i).isApprox(slow.reshaped(), kRounding)) << i;
    const auto fit = fit_least_squares(Z, Y, S);
    ASSERT_TRUE(fit);
    EXPECT_TRUE(tied->coefficients.col(i).isApprox(fit->free, kRounding)) << i;
  }
}

TEST(BlockBootstrap, EstimatesFromTheDataThemselves) {
  const Data data(1000);
  const auto found = block_bootstrap(data.Z, data.Z, data.Y, {}, kRanges, {.block_rows = 60, .replicates = 1});
  ASSERT_TRUE(found);
  const auto fit = fit_least_squares(rows_of(data.Z, kRanges), rows_of(data.Y, kRanges));
  EXPECT_TRUE(found->estimate.isApprox(fit->coefficients.reshaped(), 1e-10));
  EXPECT_NEAR(found->blocks, 397.0 / 60.0 + 1.0 + 530.0 / 60.0, 1e-12);
}

TEST(BlockBootstrap, IsTheSameForASeedWhateverTheThreads) {
  const Data data(1000);
  const auto with = [&](std::uint64_t seed, unsigned threads, int replicates) {
    return block_bootstrap(data.Z, data.Z, data.Y, {}, kRanges,
                           {.block_rows = 60, .replicates = replicates, .seed = seed, .threads = threads})
        ->coefficients;
  };
  EXPECT_EQ(with(1, 1, 500), with(1, 4, 500));
  EXPECT_EQ(with(1, 1, 500).leftCols(100), with(1, 3, 100));
  EXPECT_NE(with(1, 1, 500), with(2, 1, 500));
}

TEST(BlockResampler, DrawsBlocksThatNeverCrossABreakUntilTheRowsAreReached) {
  const Data data(1000);
  const auto resampler = BlockResampler::make(data.Z, data.Z, data.Y, kRanges, 60);
  ASSERT_TRUE(resampler);
  std::vector<double> times(1000, 0.0);
  constexpr int kDraws = 2000;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    Index rows = 0;
    for (const RowRange& block : resampler->draw(3, i)) {
      const auto inside = [&](const RowRange& range) { return block.begin >= range.begin && block.end <= range.end; };
      EXPECT_EQ(std::ranges::count_if(kRanges, inside), 1);
      EXPECT_LE(block.size(), 60);
      rows += block.size();
      for (Index row = block.begin; row < block.end; ++row) times[static_cast<std::size_t>(row)] += 1.0 / kDraws;
    }
    EXPECT_NEAR(static_cast<double>(rows), 957.0, 15.0);  // half of the short range
  }
  // Far from the ends of a range every row is drawn alike, once; the short range stands for itself.
  const auto mean_of = [&](std::size_t begin, std::size_t end) {
    return std::accumulate(times.begin() + static_cast<std::ptrdiff_t>(begin),
                           times.begin() + static_cast<std::ptrdiff_t>(end), 0.0) /
           static_cast<double>(end - begin);
  };
  EXPECT_NEAR(mean_of(3, 400), 1.0, 0.05);
  EXPECT_NEAR(mean_of(400, 430), 1.0, 0.1);
  EXPECT_NEAR(mean_of(450, 980), 1.0, 0.05);
  EXPECT_EQ(times[440], 0.0);
  EXPECT_EQ(times[999], 0.0);
}

TEST(BlockResampler, TakesPulsesWhole) {
  const Data data(1000);
  std::vector<RowRange> pulses;
  for (Index i = 0; i < 16; ++i) pulses.push_back({60 * i, 60 * i + 50});
  const auto resampler = BlockResampler::make(data.Z, data.Z, data.Y, pulses, 200);
  ASSERT_TRUE(resampler);
  EXPECT_DOUBLE_EQ(resampler->blocks(), 16.0);
  const auto drawn = resampler->draw(1, 0);
  EXPECT_EQ(drawn.size(), 16u);
  for (const RowRange& block : drawn) EXPECT_TRUE(block.size() == 50 && block.begin % 60 == 0);
}

/// Smallest and largest ratio of the variances that two covariances give to a combination of coefficients.
std::pair<double, double> ratios(const Matrix& one, const Matrix& other) {
  const Vector values = generalized_symmetric_eigen(one, other).values;
  return {values.minCoeff(), values.maxCoeff()};
}

Matrix replicate_covariance(const Matrix& replicates) {
  const Matrix centred = replicates.colwise() - replicates.rowwise().mean();
  return centred * centred.transpose() / static_cast<double>(replicates.cols() - 1);
}

TEST(BlockBootstrap, HasTheTextbookCovarianceForWhiteNoise) {
  Random random(4);
  const Index n = 5000;
  const Matrix Z = first_order_noise(random, n, 2, 0.7), noise = first_order_noise(random, n, 1, 0.0);
  const Vector theta{{1.0, -2.0}};
  const auto found = block_bootstrap(Z, Z, Z * theta + noise, {}, {{0, n}}, {.block_rows = 10, .replicates = 4000});
  ASSERT_TRUE(found);
  // σ = 1. The variance of 4000 replicates is known to 2.2 %, that of 5000 residuals to 2 %: four times both.
  const auto [low, high] = ratios(replicate_covariance(found->coefficients), inverse(Z.transpose() * Z));
  EXPECT_GT(low, 0.87);
  EXPECT_LT(high, 1.13);
}

TEST(BlockBootstrap, HasTheCovarianceOfNeweyAndWestForColouredNoise) {
  // The variance of moving blocks of L rows is that of Bartlett's weights over L lags (Künsch 1989).
  Random random(5);
  const Index n = 40000, block = 200;
  const Matrix Z = first_order_noise(random, n, 3, 0.9);
  const Matrix Y = Z * Matrix{{1.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}} + first_order_noise(random, n, 2, 0.8);
  const auto found = block_bootstrap(Z, Z, Y, {}, {{0, n}}, {.block_rows = block, .replicates = 4000});
  const auto fit = fit_least_squares(Z, Y);
  ASSERT_TRUE(found && fit);
  const Matrix V = newey_west_covariance(*fit, Z, Y - Z * fit->coefficients, {{0, n}}, block - 1);
  const Matrix bootstrap = replicate_covariance(found->coefficients);
  const auto [low, high] = ratios(bootstrap, V);
  EXPECT_GT(low, 0.85);
  EXPECT_LT(high, 1.15);
  EXPECT_GT(ratios(bootstrap, fit->inverse_gram).first, 2.0);  // naive errors are far too small here
}

TEST(BlockBootstrap, HoldsTheTruthInNineteenOfTwentyExperiments) {
  constexpr int kRuns = 300;
  constexpr Index kRows = 3000;
  int held_corrected = 0, held_naive = 0;
  for (int run = 0; run < kRuns; ++run) {
    Random random(100 + static_cast<std::uint64_t>(run));
    const Matrix Z = first_order_noise(random, kRows, 1, 0.9);
    const Matrix Y = 2.0 * Z + first_order_noise(random, kRows, 1, 0.8);
    const auto found = block_bootstrap(Z, Z, Y, {}, {{0, kRows}},
                                       {.block_rows = 60, .replicates = 400, .seed = static_cast<std::uint64_t>(run)});
    ASSERT_TRUE(found);
    const Vector replicates = found->coefficients.row(0);
    const auto holds = [](std::pair<double, double> interval) {
      return interval.first <= 2.0 && 2.0 <= interval.second;
    };
    held_corrected += holds(bias_corrected_interval(found->estimate[0], replicates, 0.95)) ? 1 : 0;
    held_naive += holds(interval95(found->estimate[0], 1.0 / Z.norm())) ? 1 : 0;
  }
  const auto overlaps = [](int count) {
    const auto [low, high] = binomial_interval(count, kRuns, 0.99);
    return low < 0.97 && high > 0.93;
  };
  EXPECT_TRUE(overlaps(held_corrected)) << held_corrected << " of " << kRuns;
  EXPECT_LT(held_naive, 240) << "white-noise intervals should fail here";
  RecordProperty("bias_corrected", held_corrected);
  RecordProperty("naive", held_naive);
}

TEST(BlockBootstrap, SaysWhatItCannotResample) {
  const Data data(1000);
  const auto kind_of = [&](const Matrix& Z, const std::vector<RowRange>& ranges, BlockBootstrapOptions options) {
    const auto found = block_bootstrap(Z, Z, data.Y, {}, ranges, options);
    EXPECT_FALSE(found);
    return found ? ErrorKind::usage : found.error().kind;
  };
  EXPECT_EQ(kind_of(data.Z, kRanges, {.block_rows = 0}), ErrorKind::usage);
  EXPECT_EQ(kind_of(data.Z, kRanges, {.block_rows = 50, .replicates = 0}), ErrorKind::usage);
  EXPECT_EQ(kind_of(data.Z, {{0, 100}}, {.block_rows = 60}), ErrorKind::data);
  EXPECT_EQ(kind_of(data.Z, {}, {.block_rows = 60}), ErrorKind::data);
  EXPECT_EQ(kind_of(data.Z, {{0, 1001}}, {.block_rows = 60}), ErrorKind::data);
  EXPECT_EQ(kind_of(data.Z, {{500, 1000}, {0, 400}}, {.block_rows = 60}), ErrorKind::data);
  EXPECT_EQ(kind_of(data.Z.topRows(999), kRanges, {.block_rows = 60}), ErrorKind::data);
  Matrix twice = data.Z;
  twice.col(1) = 2.0 * twice.col(0);
  EXPECT_EQ(kind_of(twice, kRanges, {.block_rows = 60}), ErrorKind::not_usable);
  Matrix gap = data.Z;
  gap(440, 0) = std::numeric_limits<double>::quiet_NaN();  // between the ranges: it does not count
  EXPECT_TRUE(block_bootstrap(gap, gap, data.Y, {}, kRanges, {.block_rows = 60, .replicates = 1}));
  gap(460, 0) = gap(440, 0);
  const auto refused = block_bootstrap(gap, gap, data.Y, {}, kRanges, {.block_rows = 60});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("row 460"));
  EXPECT_FALSE(block_bootstrap(data.Z, data.Z, data.Y, Matrix::Identity(5, 5), kRanges, {.block_rows = 60}));
}

TEST(BootstrapIntervals, AreQuantilesMovedForABias) {
  Vector values(1001);
  for (Index i = 0; i < 1001; ++i) values[1000 - i] = static_cast<double>(i);  // 0 … 1000
  const auto unbiased = bias_corrected_interval(500.0, values, 0.95);
  EXPECT_NEAR(unbiased.first, 25.0, 1e-9);
  EXPECT_NEAR(unbiased.second, 975.0, 1e-9);
  // z₀ = Φ⁻¹(600.5/1001); quantiles Φ(2 z₀ ∓ 1.96)
  const auto moved = bias_corrected_interval(600.0, values, 0.95);
  const double z0 = normal_quantile(600.5 / 1001.0);
  EXPECT_NEAR(moved.first, 1000.0 * normal_probability(2.0 * z0 - kNormal95), 1e-6);
  EXPECT_NEAR(moved.second, 1000.0 * normal_probability(2.0 * z0 + kNormal95), 1e-6);
  // They follow a monotone change of scale.
  const auto logarithmic = bias_corrected_interval(std::log1p(600.0), values.array().log1p(), 0.95);
  EXPECT_NEAR(std::expm1(logarithmic.first), moved.first, 0.01);
  EXPECT_TRUE(std::isnan(bias_corrected_interval(0.0, {}, 0.95).first));
  EXPECT_TRUE(std::isnan(bias_corrected_interval(0.0, Vector::Constant(3, std::nan("")), 0.95).second));
  EXPECT_EQ(bias_corrected_interval(2000.0, values, 0.95).first, 1000.0);
}

}  // namespace block_bootstrap_test
}  // namespace mbk::numeric
