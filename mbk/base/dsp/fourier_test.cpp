#include "mbk/base/dsp/fourier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace mbk::dsp {
namespace fourier_test {

Vector noise(Index samples) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Vector values(samples);
  for (double& value : values) value = normal(random);
  return values;
}

/// The slow plain twin: the sum of the definition.
Eigen::VectorXcd plain(const Vector& signal) {
  const Index n = signal.size();
  Eigen::VectorXcd transform = Eigen::VectorXcd::Zero(n / 2 + 1);
  for (Index k = 0; k < transform.size(); ++k) {
    for (Index i = 0; i < n; ++i) {
      const double turns = static_cast<double>(i * k % n) / static_cast<double>(n);
      transform[k] += signal[i] * std::polar(1.0, -2.0 * std::numbers::pi * turns);
    }
  }
  return transform;
}

// Even and odd, of small factors, prime, twice a prime, the square of a prime.
TEST(FourierTransform, IsTheSumOfItsDefinitionAtAnyLength) {
  for (const Index n : {1, 2, 3, 7, 60, 135, 1000, 997, 1994, 961, 1013}) {
    const Vector signal = noise(n);
    const Eigen::VectorXcd got = fourier_transform(signal), expected = plain(signal);
    ASSERT_EQ(got.size(), expected.size()) << n;
    EXPECT_LT((got - expected).cwiseAbs().maxCoeff(), 1e-12 * std::sqrt(static_cast<double>(n))) << n;
  }
}

TEST(FourierTransform, OfColumnsIsThatOfEachByItself) {
  for (const Index n : {1, 2, 135, 1000, 997}) {
    for (const Index signals : {1, 2, 3, 4}) {
      const Matrix columns = noise(n * signals).reshaped(n, signals);
      const Eigen::MatrixXcd got = fourier_transforms(columns);
      ASSERT_EQ(got.rows(), n / 2 + 1);
      ASSERT_EQ(got.cols(), signals);
      for (Index k = 0; k < signals; ++k) {
        EXPECT_LT((got.col(k) - plain(columns.col(k))).cwiseAbs().maxCoeff(), 1e-12 * std::sqrt(static_cast<double>(n)))
            << n << ", column " << k << " of " << signals;
      }
    }
  }
}

TEST(FourierTransform, OfACosineIsOneLine) {
  constexpr Index kSamples = 1009, kLine = 17;
  Vector signal(kSamples);
  for (Index i = 0; i < kSamples; ++i) {
    signal[i] = std::cos(2.0 * std::numbers::pi * static_cast<double>(i * kLine % kSamples) / kSamples);
  }
  Eigen::VectorXcd transform = fourier_transform(signal);
  EXPECT_NEAR(transform[kLine].real(), 0.5 * kSamples, 1e-9);
  transform[kLine] = 0.0;
  EXPECT_LT(transform.cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace fourier_test
}  // namespace mbk::dsp
