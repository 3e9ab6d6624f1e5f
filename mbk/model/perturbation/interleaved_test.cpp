#include "mbk/model/perturbation/interleaved.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::perturbation {
namespace interleaved_test {

constexpr double kPeriod = 10.0;
constexpr double kDelays[] = {0.0, 0.1, 0.333, 2.0, 7.77};
constexpr double kRounding = 1e-12;  // sums of 1000 products of order 10

Multisine sines(std::uint64_t seed, const std::vector<int>& harmonics = {1, 4, 7, 10, 13, 16, 20, 23, 26, 29}) {
  return Multisine::with_random_phases(kPeriod, harmonics, std::vector<double>(harmonics.size(), 1.0), seed).value();
}

/// Mean of r₁(t) r₂(t + delay) over one period, exact on 1000 samples for lines below 500.
double correlation(const Multisine& first, const Multisine& second, double delay) {
  double sum = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double t = 0.001 * kPeriod * n;
    sum += first.at(t).value * second.at(t + delay).value / 1000.0;
  }
  return sum;
}

TEST(Interleaved, AxesAreUncorrelatedAtEveryDelay) {
  const auto axes = interleaved(sines(3)).value();
  EXPECT_EQ(axes[0].lines().size(), 5u);
  EXPECT_EQ(axes[1].lines().size(), 5u);
  for (const double delay : kDelays) EXPECT_NEAR(correlation(axes[0], axes[1], delay), 0.0, kRounding);
}

TEST(Interleaved, ThreeAxesHaveLinesOfTheirOwnAndAreUncorrelated) {
  const auto axes = interleaved(sines(3), 3).value();
  ASSERT_EQ(axes.size(), 3u);
  EXPECT_EQ(axes[0].lines().size() + axes[1].lines().size() + axes[2].lines().size(), 10u);
  EXPECT_EQ(axes[2].lines()[1].harmonic, 16);  // 7, 16, 26
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double delay : kDelays) {
      EXPECT_NEAR(correlation(axes[i], axes[(i + 1) % 3], delay), 0.0, kRounding) << i << ' ' << delay;
    }
  }
}

TEST(Interleaved, AxesTogetherAreTheSignal) {
  const Multisine signal = sines(3, {9, 2, 5});
  const auto axes = interleaved(signal).value();
  EXPECT_EQ(axes[1].lines()[0].harmonic, 5);
  for (const double t : {0.0, 1.1, 9.7}) {
    EXPECT_NEAR(axes[0].at(t).value + axes[1].at(t).value, signal.at(t).value, 1e-14) << t;
  }
}

TEST(Interleaved, RefusesAxesThatDoNotFit) {
  EXPECT_FALSE(interleaved(sines(1, {4})));
  EXPECT_FALSE(interleaved(sines(1, {4, 5}), 3));
  EXPECT_TRUE(interleaved(sines(1, {4, 5, 6}), 3));
}

}  // namespace interleaved_test
}  // namespace mbk::perturbation
