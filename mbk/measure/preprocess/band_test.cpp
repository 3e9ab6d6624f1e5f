#include "mbk/measure/preprocess/band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/model/perturbation/multisine.h"
#include "mbk/model/perturbation/underdamped_pulse.h"

namespace mbk::preprocess {
namespace band_test {

constexpr Hertz kRate{1000.0};

std::vector<Cut> whole(const Matrix& motion) {
  return {Cut{0, motion.rows(), {}}};
}

Vector multisine(Index samples, const std::vector<int>& harmonics) {
  const auto sines =
      perturbation::Multisine::with_random_phases(10.0, harmonics, std::vector<double>(harmonics.size(), 0.003), 5)
          .value();
  Vector x(samples);
  for (Index i = 0; i < samples; ++i) x[i] = 0.3 + sines.at(static_cast<double>(i) / kRate.value).value;
  return x;
}

TEST(ExcitedBand, OfAMultisineIsItsLowestAndHighestLine) {
  const Matrix motion = multisine(50000, {3, 7, 10, 13, 16, 20, 23, 26, 29});
  const Band band = excited_band(motion, whole(motion), kRate).value();
  const double kLine = 0.11;  // Hz: lines are 0.1 Hz apart, and a Hann window leaks into both neighbours
  EXPECT_NEAR(band.low.value, 0.3, kLine);
  EXPECT_NEAR(band.high.value, 2.9, kLine);
}

TEST(ExcitedBand, OfOneSineIsThatLine) {
  const Matrix motion = multisine(50000, {20});
  const Band band = excited_band(motion, whole(motion), kRate).value();
  EXPECT_NEAR(band.low.value, 2.0, 0.11);
  EXPECT_NEAR(band.high.value, 2.0, 0.11);
}

TEST(ExcitedBand, CountsBothAxes) {
  Matrix motion(50000, 2);
  motion.col(0) = multisine(50000, {3});
  motion.col(1) = multisine(50000, {40});
  const Band band = excited_band(motion, whole(motion), kRate).value();
  EXPECT_NEAR(band.low.value, 0.3, 0.11);
  EXPECT_NEAR(band.high.value, 4.0, 0.11);
}

TEST(ExcitedBand, OfUnderdampedPulsesSurroundsTheirResonance) {
  const auto pulse = perturbation::UnderdampedPulse::create(0.005).value();
  Matrix motion(1700 * 4, 1);
  std::vector<Cut> cuts;
  for (Index k = 0; k < 4; ++k) {
    for (Index i = 0; i < 1700; ++i) motion(1700 * k + i, 0) = pulse.at(static_cast<double>(i) / kRate.value).value;
    cuts.push_back({1700 * k, 1700 * (k + 1), {}});
  }
  const Band band = excited_band(motion, cuts, kRate).value();
  const double resonance = 15.0 / (2.0 * std::numbers::pi);  // 2.39 Hz
  EXPECT_LT(band.low.value, resonance);
  EXPECT_GT(band.high.value, resonance);
  EXPECT_LT(band.high.value, 4.0 * resonance);
}

TEST(ExcitedBand, LooksNoHigherThanATenthOfTheRate) {
  const Matrix motion = multisine(50000, {10, 2000});  // 1 Hz and 200 Hz
  EXPECT_NEAR(excited_band(motion, whole(motion), kRate)->high.value, 1.0, 0.11);
}

TEST(ExcitedBand, CutsOfDifferentLengthsCount) {
  const Matrix motion = multisine(3711, {20});
  const auto band = excited_band(motion, {Cut{0, 1000, {}}, Cut{1000, 2011, {}}, Cut{2011, 3711, {}}}, kRate);
  ASSERT_TRUE(band) << band.error().line();
  EXPECT_NEAR(band->high.value, 2.0, 1.1);  // 1000 samples resolve 1 Hz
}

TEST(ExcitedBand, OfEightSamplesIsFoundAndOfSevenRefused) {
  const Matrix motion = multisine(100, {20});
  EXPECT_TRUE(excited_band(motion, {Cut{0, 8, {}}}, kRate));
  const auto refused = excited_band(motion, {Cut{0, 50, {}}, Cut{50, 57, {}}}, kRate);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("7 samples"), std::string::npos) << refused.error().message;
}

TEST(ExcitedBand, OfNoMotionIsZero) {
  const Matrix still = Matrix::Constant(1000, 1, 0.25);
  const Band band = excited_band(still, whole(still), kRate).value();
  EXPECT_EQ(band.low.value, 0.0);
  EXPECT_EQ(band.high.value, 0.0);
}

TEST(BandTop, IsWhereTheSignalsOwnPowerEnds) {
  Matrix signals(50000, 2);
  signals.col(0) = multisine(50000, {10});        // 1 Hz
  signals.col(1) = 0.5 * multisine(50000, {70});  // 7 Hz with a fifth of the power of both
  EXPECT_NEAR(band_top(signals, whole(signals), kRate)->value, 7.0, 0.11);
  signals.col(1) *= 0.2;  // below 5 % of it
  EXPECT_NEAR(band_top(signals, whole(signals), kRate)->value, 1.0, 0.21);
  EXPECT_FALSE(band_top(signals, {Cut{0, 7, {}}}, kRate));
}

TEST(MotionTop, IsWhereTheAccelerationSinksIntoItsFloor) {
  // Acceleration of one size up to 8 Hz, and of a fifth of it up to 40 Hz, which stands for noise.
  Vector position = Vector::Zero(50000);
  for (int line = 1; line <= 80; ++line) {
    const double omega = 2.0 * std::numbers::pi * 0.5 * line, amplitude = (line <= 16 ? 1.0 : 0.2) / (omega * omega);
    for (Index i = 0; i < position.size(); ++i) {
      position[i] += amplitude * std::sin(omega * static_cast<double>(i) / kRate.value + line * line);
    }
  }
  const double top = motion_top(position, whole(position), kRate, Hertz(40.0))->value;
  EXPECT_GT(top, 8.0);
  EXPECT_LT(top, 10.1);  // a Hann window of 1 s leaks into two lines of 1 Hz
}

TEST(MotionTop, IsTheLimitWhereTooFewLinesLieBetween) {
  const Vector motion = multisine(50000, {10, 20, 40});
  EXPECT_EQ(motion_top(motion, whole(motion), kRate, Hertz(7.0))->value, 7.0);
}

}  // namespace band_test
}  // namespace mbk::preprocess
