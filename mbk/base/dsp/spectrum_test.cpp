#include "mbk/base/dsp/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace mbk::dsp {
namespace {

TEST(Spectrum, IntegratesToTheVariance) {
  std::mt19937 random(1);
  Vector signal(60000);
  for (double& value : signal) value = static_cast<double>(random()) / 4294967296.0 - 0.5;  // variance 1/12
  const Spectrum spectrum = welch(signal, Hertz(1000.0), Hertz(1.0)).value();
  const double spacing = spectrum.frequency[1] - spectrum.frequency[0];
  EXPECT_NEAR(spectrum.density.sum() * spacing, 1.0 / 12.0, 0.002);  // 60 segments: about 1 %
}

TEST(Spectrum, PutsASineInItsPlaceWithItsPower) {
  Vector signal(50000);
  for (Index i = 0; i < signal.size(); ++i) {
    signal[i] = 2.0 * std::sin(2.0 * std::numbers::pi * 3.0 * static_cast<double>(i) / 1000.0);
  }
  const Spectrum spectrum = welch(signal, Hertz(1000.0), Hertz(0.1)).value();
  Index peak = 0;
  spectrum.density.maxCoeff(&peak);
  EXPECT_NEAR(spectrum.frequency[peak], 3.0, 1e-9);
  EXPECT_NEAR(spectrum.density.sum() * 0.1, 2.0, 0.01);
  EXPECT_NEAR(power_quantile(spectrum, 0.95, Hertz(100.0)).value, 3.0, 0.15);
  EXPECT_LE(power_quantile(spectrum, 0.95, Hertz(1.0)).value, 1.0);
}

TEST(Spectrum, TransformsOnlyLengthsOfSmallFactors) {
  EXPECT_EQ(fast_length_below(1000), 1000);
  EXPECT_EQ(fast_length_below(49999), 49152);
  EXPECT_EQ(fast_length_below(7), 6);
  EXPECT_EQ(fast_length_below(1), 1);
  EXPECT_EQ(fast_length_above(1000), 1000);
  EXPECT_EQ(fast_length_above(1001), 1024);
  EXPECT_EQ(fast_length_above(1025), 1080);  // the transform of real numbers wants an even length: 1125 is not
  EXPECT_EQ(fast_length_above(0), 2);
}

TEST(Spectrum, ASegmentIsEvenAndItsTransformFastHoweverLongTheRecording) {
  for (const Hertz resolution : {Hertz(0.01), Hertz(0.1), Hertz(1.0 / 12.347), Hertz(1000.0)}) {
    for (Index longest = 8; longest < 25000; ++longest) {
      const Index length = segment_length(Hertz(1000.0), resolution, longest);
      ASSERT_EQ(length % 2, 0) << longest;  // 3⁹ − 1 = 2·13·757 is not what 3⁹ becomes
      ASSERT_EQ(fast_length_below(length), length) << longest;
      const Index requested = std::min(longest, std::max<Index>(8, static_cast<Index>(1000.0 / resolution.value)));
      ASSERT_LE(length, requested) << longest;
      ASSERT_GT(fast_length_above(length + 1), requested) << longest;
    }
  }
}

TEST(Spectrum, RefusesTooLittle) {
  EXPECT_FALSE(welch(Vector::Zero(7), Hertz(1000.0), Hertz(1.0)));
  EXPECT_FALSE(welch(Vector::Zero(100), Hertz(0.0), Hertz(1.0)));
  EXPECT_TRUE(welch(Vector::Zero(8), Hertz(1000.0), Hertz(1.0)));
}

}  // namespace
}  // namespace mbk::dsp
