#include "mbk/simulate/participant/remnant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace mbk::participant {
namespace remnant_test {

constexpr double kTick = 1e-3;

std::vector<Eigen::Vector2d> noise(double voluntary, std::uint64_t seed, std::uint32_t stream, int samples) {
  auto remnant = Remnant<2>::create({}, kTick, seed, stream).value();
  std::vector<Eigen::Vector2d> values;
  for (int i = 0; i < samples; ++i) values.push_back(remnant.step(voluntary));
  return values;
}

TEST(Remnant, HasTheVarianceAndMemoryThatWereAsked) {
  const int samples = 2'000'000;
  const auto values = noise(5.0, 1, 0, samples);
  const double sigma = 0.15 + 0.08 * 5.0;
  // 2000 s of noise with a time constant of 0.106 s: about 9400 independent values, 1.5 % error of a variance
  const int lag = 100;
  const double memory = std::exp(-2.0 * std::numbers::pi * 1.5 * kTick * lag);
  for (int axis = 0; axis < 2; ++axis) {
    double variance = 0.0, lagged = 0.0;
    for (int i = lag; i < samples; ++i) {
      const double now = values[static_cast<std::size_t>(i)][axis];
      variance += now * now / (samples - lag);
      lagged += now * values[static_cast<std::size_t>(i - lag)][axis] / (samples - lag);
    }
    EXPECT_NEAR(variance, sigma * sigma, 0.06 * sigma * sigma);
    EXPECT_NEAR(lagged / variance, memory, 0.04);
  }
}

TEST(Remnant, FirstSampleIsAsLargeAsAnyOther) {
  double variance = 0.0;
  const int seeds = 2000;  // 3.2 % error of a variance
  for (int seed = 0; seed < seeds; ++seed)
    variance += noise(0.0, static_cast<std::uint64_t>(seed), 0, 1)[0].squaredNorm() / (2.0 * seeds);
  EXPECT_NEAR(variance, 0.15 * 0.15, 0.12 * 0.15 * 0.15);
}

TEST(Remnant, ComesFromSeedAndStream) {
  EXPECT_EQ(noise(1.0, 7, 3, 50), noise(1.0, 7, 3, 50));
  EXPECT_NE(noise(1.0, 7, 3, 50), noise(1.0, 8, 3, 50));
  EXPECT_NE(noise(1.0, 7, 3, 50), noise(1.0, 7, 4, 50));
}

TEST(Remnant, RefusesNegativeNoise) {
  EXPECT_FALSE(Remnant<2>::create({.floor = -0.1}, kTick, 1));
  EXPECT_FALSE(Remnant<1>::create({.cutoff = Hertz(0.0)}, kTick, 1));
}

}  // namespace remnant_test
}  // namespace mbk::participant
