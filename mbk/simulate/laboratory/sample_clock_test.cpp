#include "mbk/simulate/laboratory/sample_clock.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::laboratory {
namespace sample_clock_test {

using numeric::Random;

constexpr double kTick = 1e-3;

TEST(SampleClock, WithoutJitterKeepsTheSampleTime) {
  SampleClock clock(0.0, kTick, Random(1));
  for (int k = 0; k < 100; ++k) ASSERT_EQ(clock.next_interval(), kTick);
}

TEST(SampleClock, IntervalsHaveTheirMeanAndDeviationAndTheTimeStaysOnItsGrid) {
  constexpr double kJitter = 2e-5;
  constexpr int kCount = 100000;
  SampleClock clock(kJitter, kTick, Random(1));
  double time = 0.0, square = 0.0, farthest = 0.0;
  for (int k = 1; k <= kCount; ++k) {
    const double interval = clock.next_interval();
    time += interval;
    square += std::pow(interval - kTick, 2) / kCount;
    farthest = std::max(farthest, std::abs(time - k * kTick));
  }
  EXPECT_NEAR(std::sqrt(square), kJitter, 0.01 * kJitter);  // neighbours correlate by −½: an error is 0.27 %
  EXPECT_LT(farthest, 6.0 * kJitter);                       // errors do not add up to √100000 of them
}

TEST(SampleClock, TimeGoesOnHoweverLargeTheJitter) {
  SampleClock clock(10.0 * kTick, kTick, Random(1));
  for (int k = 0; k < 10000; ++k) ASSERT_GE(clock.next_interval(), 0.1 * kTick * (1.0 - 1e-12));
}

}  // namespace sample_clock_test
}  // namespace mbk::laboratory
