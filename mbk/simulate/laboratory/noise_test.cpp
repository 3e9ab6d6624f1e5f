#include "mbk/simulate/laboratory/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace mbk::laboratory {
namespace noise_test {

using numeric::Random;

constexpr double kTick = 1e-3;

template <class Noise>
std::vector<double> draw(Noise noise, int count) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(noise.next());
  return values;
}

/// Mean of x[k] x[k + lag].
double correlation(const std::vector<double>& x, std::size_t lag = 0) {
  double sum = 0.0;
  for (std::size_t k = 0; k + lag < x.size(); ++k) sum += x[k] * x[k + lag];
  return sum / static_cast<double>(x.size() - lag);
}

TEST(WhiteNoise, HasItsDeviationAndNoMemory) {
  constexpr int kCount = 200000;
  const std::vector<double> noise = draw(WhiteNoise(0.3, Random(1)), kCount);
  const double five_errors = 5.0 * 0.09 * std::sqrt(2.0 / kCount);
  EXPECT_NEAR(correlation(noise), 0.09, five_errors);
  for (const std::size_t lag : {1u, 2u, 10u}) EXPECT_NEAR(correlation(noise, lag), 0.0, five_errors) << lag;
}

TEST(ColouredNoise, CorrelatesAsAFirstOrderLowpassFromTheFirstSample) {
  // E c[0] c[m] = σ² e^{−2π f m T} over an ensemble of seeds: stationary at once
  constexpr int kSeeds = 20000;
  double at_once = 0.0, later = 0.0, between = 0.0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const std::vector<double> noise = draw(ColouredNoise(0.5, Hertz(20.0), kTick, Random(seed)), 9);
    at_once += noise[0] * noise[0];
    later += noise[8] * noise[8];
    between += noise[0] * noise[8];
  }
  const double five_errors = 5.0 * 0.25 * std::sqrt(2.0 / kSeeds);
  EXPECT_NEAR(at_once / kSeeds, 0.25, five_errors);
  EXPECT_NEAR(later / kSeeds, 0.25, five_errors);
  EXPECT_NEAR(between / kSeeds, 0.25 * std::exp(-2.0 * M_PI * 20.0 * 8.0 * kTick), five_errors);
}

TEST(Drift, VarianceOfTheWalkGrowsLinearlyWithTime) {
  constexpr int kSeeds = 4000;
  constexpr double kWalk = 0.2;
  const std::vector<int> times = {0, 100, 400, 1600};
  std::vector<double> square(times.size(), 0.0);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const std::vector<double> drift = draw(Drift(kWalk, 0.0, kTick, Random(seed)), times.back() + 1);
    for (std::size_t i = 0; i < times.size(); ++i) {
      square[i] += std::pow(drift[static_cast<std::size_t>(times[i])], 2) / kSeeds;
    }
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double expected = kWalk * kWalk * times[i] * kTick;
    EXPECT_NEAR(square[i], expected, 5.0 * expected * std::sqrt(2.0 / kSeeds)) << times[i] << " ms";
  }
}

TEST(Drift, WithoutAWalkIsALine) {
  const std::vector<double> drift = draw(Drift(0.0, -0.25, kTick, Random(1)), 1001);
  EXPECT_EQ(drift[0], 0.0);
  EXPECT_NEAR(drift[1000], -0.25, 1e-15);
}

TEST(Quantised, ErrsByHalfAStepAtMostAndByItsTwelfthInSquare) {
  constexpr double kStep = 2e-6;
  constexpr int kCount = 100000;
  Random random(3);
  double largest = 0.0, square = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const double value = random.uniform(-0.3, 0.3), error = quantised(value, kStep) - value;
    largest = std::max(largest, std::abs(error));
    square += error * error / kCount;
  }
  EXPECT_LE(largest, 0.5 * kStep * (1.0 + 1e-9));  // rounding of 0.3 is 3e-11 of a step
  EXPECT_NEAR(std::sqrt(square), kStep / std::sqrt(12.0), 0.01 * kStep / std::sqrt(12.0));  // 7 standard errors
  EXPECT_EQ(quantised(0.1234567, 0.0), 0.1234567);
}

TEST(NoiseStream, DiffersForEverySourceAndAxisAndOnlyForThem) {
  using enum NoiseSource;
  std::set<double> first;
  for (const NoiseSource source :
       {white_force, coloured_force, force_drift, strain_gauge, acceleration, motor_current, clock}) {
    for (const std::uint32_t axis : {0u, 1u, 9u}) {
      EXPECT_TRUE(first.insert(noise_stream(7, source, axis).uniform()).second);
      EXPECT_FALSE(first.insert(noise_stream(7, source, axis).uniform()).second);
    }
  }
}

TEST(NoiseSources, SwitchedOffAddNothing) {
  EXPECT_EQ(WhiteNoise(0.0, Random(1)).next(), 0.0);
  EXPECT_EQ(ColouredNoise(0.0, Hertz(1.5), kTick, Random(1)).next(), 0.0);
  EXPECT_EQ(draw(Drift(0.0, 0.0, kTick, Random(1)), 100).back(), 0.0);
}

}  // namespace noise_test
}  // namespace mbk::laboratory
