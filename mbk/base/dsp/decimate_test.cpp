#include "mbk/base/dsp/decimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mbk::dsp {
namespace decimate_test {

constexpr Hertz kRate(1000.0);

Matrix sine(double frequency, Index samples = 4000) {
  Matrix signal(samples, 1);
  for (Index i = 0; i < samples; ++i) {
    signal(i, 0) = std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(i) / kRate.value);
  }
  return signal;
}

/// Largest value away from the ends.
double height(const Matrix& signal) {
  return signal.middleRows(signal.rows() / 4, signal.rows() / 2).cwiseAbs().maxCoeff();
}

TEST(Decimate, KeepsWhatIsSlowSampleForSample) {
  const Matrix slow = sine(5.0), thin = *decimate(slow, kRate, 10, 3);
  ASSERT_EQ(thin.rows(), 400);
  for (Index k = 100; k < 300; ++k) EXPECT_NEAR(thin(k, 0), slow(3 + 10 * k, 0), 1e-6);
}

TEST(Decimate, TakesAwayWhatWouldFold) {
  EXPECT_LT(height(*decimate(sine(60.0), kRate, 10)), 0.003);  // would be 40 Hz
  EXPECT_LT(height(*decimate(sine(99.0), kRate, 10)), 1e-4);   // would be 1 Hz
  EXPECT_NEAR(height(*decimate(sine(40.0), kRate, 10)), 0.5, 0.05);
}

TEST(Decimate, LeavesEverySampleAsItIs) {
  const Matrix signal = sine(300.0, 50);
  EXPECT_EQ(*decimate(signal, kRate, 1), signal);
}

TEST(Decimate, RefusesWhatCannotBe) {
  EXPECT_EQ(decimate(sine(1.0), kRate, 0).error().kind, ErrorKind::usage);
  EXPECT_EQ(decimate(sine(1.0), kRate, 2, 4000).error().kind, ErrorKind::usage);
  EXPECT_FALSE(decimate(sine(1.0, 50), kRate, 10));
}

}  // namespace decimate_test
}  // namespace mbk::dsp
