#include "mbk/base/dsp/autocorrelation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mbk::dsp {
namespace autocorrelation_test {

Vector noise(Index samples, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Vector values(samples);
  for (double& value : values) value = normal(random);
  return values;
}

/// The slow plain twin: the sums of the definition.
Vector plain(const std::vector<Vector>& pieces, Index last) {
  Vector sums = Vector::Zero(last + 1);
  for (const Vector& piece : pieces) {
    for (Index lag = 0; lag <= std::min(last, piece.size() - 1); ++lag) {
      for (Index t = 0; t + lag < piece.size(); ++t) sums[lag] += piece[t] * piece[t + lag];
    }
  }
  return sums / sums[0];
}

TEST(Autocorrelation, AgreesWithItsSums) {
  constexpr double kRounding = 1e-14;  // of a transform of a thousand numbers near one
  for (const Index last : {0, 1, 7, 300}) {
    const std::vector<Vector> pieces = {noise(500, 1), noise(1, 2), noise(123, 3), Vector()};
    const Vector r = autocorrelation(pieces, last);
    ASSERT_EQ(r.size(), last + 1);
    EXPECT_EQ(r[0], 1.0);
    EXPECT_LT((r - plain(pieces, last)).cwiseAbs().maxCoeff(), kRounding) << last;
  }
}

TEST(Autocorrelation, IsThatOfAnAutoregressiveProcess) {
  constexpr double kSpread = 0.012;  // four of √((1 + a²)/((1 − a²) N)), far lags of a first-order process
  Vector series = noise(600000, 13);
  for (Index i = 1; i < series.size(); ++i) series[i] += 0.8 * series[i - 1];
  const Vector r = autocorrelation({series}, 60);
  for (Index lag = 0; lag <= 60; ++lag) EXPECT_NEAR(r[lag], std::pow(0.8, lag), kSpread) << lag;
}

TEST(Autocorrelation, OfWhiteNoiseStaysWithinItsBandInNineteenOfTwentyLags) {
  const Index samples = 20000, last = 2000;
  const Vector r = autocorrelation({noise(samples, 14)}, last);
  const double band = 1.96 / std::sqrt(static_cast<double>(samples));
  const double outside = static_cast<double>((r.tail(last).array().abs() > band).count()) / static_cast<double>(last);
  EXPECT_NEAR(outside, 0.05, 0.02);  // four of √(0.05 · 0.95/2000), and the bias takes 5 % off the last lags
}

TEST(Autocorrelation, OfASineIsACosineThatShrinksByTheMissingPairs) {
  const Index samples = 1000, period = 50;
  Vector sine(samples);
  for (Index i = 0; i < samples; ++i) sine[i] = std::sin(2.0 * M_PI * static_cast<double>(i) / period);
  const Vector r = autocorrelation({sine}, samples / 2);
  for (Index lag = 0; lag <= samples / 2; lag += period / 2) {
    const double kept = 1.0 - static_cast<double>(lag) / samples, sign = lag % period == 0 ? 1.0 : -1.0;
    EXPECT_NEAR(r[lag], sign * kept, 1e-12) << lag;
  }
}

TEST(Autocorrelation, NeverPairsSamplesAcrossABreak) {
  const Vector a = (Vector(3) << 1.0, 2.0, 3.0).finished(), b = (Vector(2) << 4.0, 5.0).finished();
  const Vector r = autocorrelation({a, b}, 6);
  const Vector want = (Vector(7) << 55.0, 2.0 + 6.0 + 20.0, 3.0, 0.0, 0.0, 0.0, 0.0).finished() / 55.0;
  EXPECT_LT((r - want).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(Autocorrelation, IsUndefinedWithoutASignal) {
  EXPECT_TRUE(autocorrelation({Vector::Zero(4)}, 2).array().isNaN().all());
  EXPECT_TRUE(autocorrelation({}, 2).array().isNaN().all());
  EXPECT_EQ(autocorrelation({Vector::Constant(1, 3.0)}, 0)[0], 1.0);
}

}  // namespace autocorrelation_test
}  // namespace mbk::dsp
