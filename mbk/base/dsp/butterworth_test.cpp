#include "mbk/base/dsp/butterworth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace mbk::dsp {
namespace butterworth_test {

constexpr double kEps = 2.3e-16;
const Hertz kRate(1000.0);

TEST(Butterworth, HasHalfPowerAtItsCutoffAndUnitGainAtZero) {
  for (int order = 1; order <= 12; ++order) {
    for (const double cutoff : {0.5, 4.5, 5.0, 25.0, 100.0, 499.0}) {
      SCOPED_TRACE(testing::Message() << "order " << order << ", cutoff " << cutoff << " Hz");
      const auto filter = butterworth_lowpass(order, Hertz(cutoff), kRate);
      ASSERT_TRUE(filter);
      // Near 0 and near Nyquist 1 ± a1 + a2 ≈ (2π f/fs)² is a difference of numbers near 1: the gain loses its
      // rounding.
      const double tolerance =
          100.0 * kEps * std::pow(kRate.value / (6.28 * std::min(cutoff, 500.0 - cutoff)), 2) + 1e-12;
      EXPECT_NEAR(gain(*filter, Hertz(0.0), kRate), 1.0, tolerance);
      EXPECT_NEAR(gain(*filter, Hertz(cutoff), kRate), std::sqrt(0.5), tolerance);
    }
  }
}

TEST(Butterworth, FollowsItsClosedForm) {
  // |H|² = 1/(1 + (tan(πf/fs)/tan(πfc/fs))^2n)
  const auto filter = butterworth_lowpass(5, Hertz(5.0), kRate);
  ASSERT_TRUE(filter);
  for (double f = 0.25; f < 60.0; f *= 1.3) {
    const double ratio = std::tan(M_PI * f / 1000.0) / std::tan(M_PI * 5.0 / 1000.0);
    const double expected = 1.0 / std::sqrt(1.0 + std::pow(ratio, 10.0));
    EXPECT_NEAR(gain(*filter, Hertz(f), kRate), expected, 1e-11) << f << " Hz";
  }
}

TEST(Butterworth, HighPassFollowsItsClosedForm) {
  // |H|² = 1/(1 + (tan(πfc/fs)/tan(πf/fs))^2n)
  for (const int order : {1, 2, 5}) {
    const auto filter = butterworth_highpass(order, Hertz(20.0), kRate);
    ASSERT_TRUE(filter);
    EXPECT_NEAR(gain(*filter, Hertz(0.0), kRate), 0.0, 1e-12);
    for (double f = 2.0; f < 499.0; f *= 1.3) {
      const double ratio = std::tan(M_PI * 20.0 / 1000.0) / std::tan(M_PI * f / 1000.0);
      EXPECT_NEAR(gain(*filter, Hertz(f), kRate), 1.0 / std::sqrt(1.0 + std::pow(ratio, 2 * order)), 1e-11) << f;
    }
  }
  EXPECT_FALSE(butterworth_highpass(2, Hertz(600.0), kRate));
}

TEST(Butterworth, ForwardAndBackwardAtFiveHertzHasThePublishedGains) {
  const auto filter = butterworth_lowpass(5, Hertz(5.0), kRate);
  ASSERT_TRUE(filter);
  const auto twice = [&](double f) { return std::pow(gain(*filter, Hertz(f), kRate), 2); };
  EXPECT_NEAR(twice(3.0), 0.994, 5e-4);
  EXPECT_NEAR(twice(4.0), 0.903, 5e-4);
  EXPECT_NEAR(twice(5.0), 0.500, 5e-4);
}

TEST(Butterworth, RefusesWhatCannotBe) {
  EXPECT_FALSE(butterworth_lowpass(0, Hertz(5.0), kRate));
  EXPECT_FALSE(butterworth_lowpass(21, Hertz(5.0), kRate));
  EXPECT_FALSE(butterworth_lowpass(5, Hertz(0.0), kRate));
  EXPECT_FALSE(butterworth_lowpass(5, Hertz(std::nan("")), kRate));
  const auto high = butterworth_lowpass(5, Hertz(600.0), kRate);
  ASSERT_FALSE(high);
  for (const char* limit : {"600 Hz", "500 Hz"}) EXPECT_NE(high.error().message.find(limit), std::string::npos);
}

}  // namespace butterworth_test
}  // namespace mbk::dsp
