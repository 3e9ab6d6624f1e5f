#include "mbk/model/perturbation/axis_pair.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::perturbation {
namespace axis_pair_test {

constexpr double kPeriod = 10.0;
constexpr double kRounding = 1e-12;  // sums of 1000 products of order 10

Multisine sines(std::uint64_t seed, const std::vector<int>& harmonics = {1, 4, 7, 10, 13, 16, 20, 23, 26, 29}) {
  return Multisine::with_random_phases(kPeriod, harmonics, std::vector<double>(harmonics.size(), 1.0), seed).value();
}

/// Mean of r₁(t) r₂(t + delay) over one period, exact on 1000 samples for lines below 500.
double correlation(const AxisPair& pair, double delay) {
  double sum = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const double t = 0.001 * kPeriod * n;
    sum += pair.first.at(t).value * pair.second.at(t + delay).value / 1000.0;
  }
  return sum;
}

TEST(AxisPair, InterleavedAxesAreUncorrelatedAtEveryDelay) {
  const AxisPair pair = interleaved(sines(3)).value();
  EXPECT_EQ(pair.first.lines().size(), 5u);
  EXPECT_EQ(pair.second.lines().size(), 5u);
  for (const double delay : {0.0, 0.1, 0.333, 2.0, 7.77}) EXPECT_NEAR(correlation(pair, delay), 0.0, kRounding);
}

TEST(AxisPair, InterleavedAxesTogetherAreTheSignal) {
  const Multisine signal = sines(3, {9, 2, 5});
  const AxisPair pair = interleaved(signal).value();
  EXPECT_EQ(pair.second.lines()[0].harmonic, 5);
  for (const double t : {0.0, 1.1, 9.7}) {
    EXPECT_NEAR(pair.first.at(t).value + pair.second.at(t).value, signal.at(t).value, 1e-14) << t;
  }
}

TEST(AxisPair, RefusesAxesThatDoNotFit) {
  EXPECT_FALSE(interleaved(sines(1, {4})));
}

}  // namespace axis_pair_test
}  // namespace mbk::perturbation
