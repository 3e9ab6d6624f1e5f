#include "mbk/base/dsp/complex_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace mbk::dsp {
namespace complex_transform_test {

Eigen::VectorXcd noise(Index samples) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Eigen::VectorXcd values(samples);
  for (std::complex<double>& value : values) value = {normal(random), normal(random)};
  return values;
}

/// The slow plain twin: the sum of the definition.
Eigen::VectorXcd plain(const Eigen::VectorXcd& signal) {
  const Index n = signal.size();
  Eigen::VectorXcd transform = Eigen::VectorXcd::Zero(n);
  for (Index k = 0; k < n; ++k) {
    for (Index i = 0; i < n; ++i) {
      const double turns = static_cast<double>(i * k % n) / static_cast<double>(n);
      transform[k] += signal[i] * std::polar(1.0, -2.0 * std::numbers::pi * turns);
    }
  }
  return transform;
}

Eigen::VectorXcd transformed(const Eigen::VectorXcd& signal) {
  ComplexTransform transform(signal.size());
  transform.real() = signal.real();
  transform.imaginary() = signal.imag();
  transform.run();
  Eigen::VectorXcd result(signal.size());
  result.real() = transform.real();
  result.imag() = transform.imaginary();
  return result;
}

constexpr double kRounding = 2e-15;  // of the largest sum, for each of log n passes

// Each factor alone and each with each other, odd and even strides, and primes that have no loop of their own.
TEST(ComplexTransform, IsTheSumOfItsDefinitionAtAnyLength) {
  for (const Index n : {1,  2,  3,  4,  5,   6,   7,   8,   9,   10,  12,  15,  16,  20,  25,   27,   30,
                        45, 49, 64, 77, 100, 120, 135, 375, 500, 512, 625, 720, 729, 997, 1000, 1024, 1430}) {
    const Eigen::VectorXcd signal = noise(n);
    const double largest = static_cast<double>(n) * signal.cwiseAbs().maxCoeff();
    EXPECT_LT((transformed(signal) - plain(signal)).cwiseAbs().maxCoeff(), kRounding * largest) << n;
  }
}

TEST(ComplexTransform, ExchangedGivesTheInverse) {
  for (const Index n : {60, 4000, 10000}) {
    const Eigen::VectorXcd signal = noise(n);
    ComplexTransform transform(n);
    transform.real() = signal.real();
    transform.imaginary() = signal.imag();
    transform.run();
    transform.real().swap(transform.imaginary());
    transform.run();
    EXPECT_LT((transform.imaginary() / static_cast<double>(n) - signal.real()).cwiseAbs().maxCoeff(), 1e-14) << n;
    EXPECT_LT((transform.real() / static_cast<double>(n) - signal.imag()).cwiseAbs().maxCoeff(), 1e-14) << n;
  }
}

// Parseval: what a length of many passes makes of noise has n times its power, whatever the phases.
TEST(ComplexTransform, KeepsThePower) {
  for (const Index n : {10000, 15360, 50000}) {
    const Eigen::VectorXcd signal = noise(n);
    EXPECT_NEAR(transformed(signal).squaredNorm() / (static_cast<double>(n) * signal.squaredNorm()), 1.0, 1e-13) << n;
  }
}

}  // namespace complex_transform_test
}  // namespace mbk::dsp
