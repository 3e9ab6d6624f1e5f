#include "mbk/dsp/cross_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "mbk/dsp/spectrum.h"

namespace mbk::dsp {
namespace {

const Hertz kRate(100.0);

Vector noise(Index samples, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Vector values(samples);
  for (double& value : values) value = normal(random);
  return values;
}

Matrix side_by_side(std::initializer_list<Vector> signals) {
  Matrix all(signals.begin()->size(), static_cast<Index>(signals.size()));
  Index column = 0;
  for (const Vector& signal : signals) all.col(column++) = signal;
  return all;
}

TEST(CrossSpectra, HaveThePowerSpectraOnTheirDiagonal) {
  const Matrix signals = side_by_side({noise(3000, 1), noise(3000, 2)});
  const CrossSpectra spectra = cross_spectra({signals}, kRate, Hertz(0.5)).value();
  for (Index k = 0; k < 2; ++k) {
    const Spectrum alone = welch(signals.col(k), kRate, Hertz(0.5)).value();
    ASSERT_EQ(spectra.frequency, alone.frequency);
    for (Index line = 0; line < alone.density.size(); ++line) {
      EXPECT_NEAR(spectra.density[static_cast<std::size_t>(line)](k, k).real(), alone.density[line],
                  1e-12 * alone.density.maxCoeff());
    }
  }
}

TEST(CrossSpectra, AgreeWithSumsOverTheSamples) {
  // The slow plain twin: one segment, the transform by its definition.
  const Index n = 40;
  const Matrix signals = side_by_side({noise(n, 3), noise(n, 4)});
  const CrossSpectra spectra = cross_spectra({signals}, kRate, Hertz(2.5)).value();
  ASSERT_EQ(spectra.segments, 1);
  const Vector window = hann_window(n);
  for (Index line = 0; line <= n / 2; ++line) {
    std::complex<double> X[2];
    for (Index k = 0; k < 2; ++k) {
      const double mean = signals.col(k).mean();
      for (Index i = 0; i < n; ++i) {
        const double angle = -2.0 * std::numbers::pi * static_cast<double>(line * i) / static_cast<double>(n);
        X[k] += window[i] * (signals(i, k) - mean) * std::polar(1.0, angle);
      }
    }
    const double sides = line == 0 || line == n / 2 ? 1.0 : 2.0;
    const std::complex<double> want = sides * X[0] * std::conj(X[1]) / (kRate.value * window.squaredNorm());
    EXPECT_LT(std::abs(spectra.density[static_cast<std::size_t>(line)](0, 1) - want), 1e-14);
  }
}

TEST(CrossSpectra, NeverReachAcrossABreak) {
  // Two pieces whose means differ by far: a segment across the break would see a step.
  const Vector quiet = 1e-6 * noise(400, 5);
  const Matrix low = side_by_side({quiet}), high = (low.array() + 1000.0).matrix();
  const CrossSpectra spectra = cross_spectra({low, high}, kRate, Hertz(1.0)).value();
  for (const Eigen::MatrixXcd& density : spectra.density) EXPECT_LT(density(0, 0).real(), 1e-10);
  EXPECT_EQ(spectra.segments, 14);
}

TEST(CrossSpectra, RefuseTooLittle) {
  EXPECT_FALSE(cross_spectra({}, kRate, Hertz(1.0)));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(7, 2)}, kRate, Hertz(1.0)));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(100, 2), Matrix::Zero(100, 1)}, kRate, Hertz(1.0)));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(100, 2)}, kRate, Hertz(0.0)));
}

TEST(MultipleCoherence, IsOneForALinearRelationAndTheShareOfPowerWithNoise) {
  const Index n = 60000;
  const Vector x = noise(n, 6), y = noise(n, 7), e = noise(n, 8);
  const Vector exact = 2.0 * x - 0.5 * y, noisy = 2.0 * x + y + e;  // 5 of 6 parts of the power
  const CrossSpectra spectra = cross_spectra({side_by_side({x, y, exact, noisy})}, kRate, Hertz(1.0)).value();
  const Matrix coherence = multiple_coherence(spectra, 2);
  EXPECT_GT(coherence.col(0).minCoeff(), 1.0 - 1e-9);
  EXPECT_NEAR(coherence.col(1).mean(), 5.0 / 6.0, 0.005);
  EXPECT_GE(coherence.minCoeff(), 0.0);
  EXPECT_LE(coherence.maxCoeff(), 1.0);
}

TEST(MultipleCoherence, SeesWhatOneInputAloneDoesNot) {
  const Index n = 20000;
  const Vector x = noise(n, 9), y = noise(n, 10);
  const CrossSpectra both = cross_spectra({side_by_side({x, y, x + y})}, kRate, Hertz(1.0)).value(),
                     one = cross_spectra({side_by_side({x, x + y})}, kRate, Hertz(1.0)).value();
  EXPECT_GT(multiple_coherence(both, 2).minCoeff(), 1.0 - 1e-9);
  EXPECT_NEAR(multiple_coherence(one, 1).mean(), 0.5, 0.02);
}

TEST(MultipleCoherence, IsUndefinedWhereInputsCannotBeToldApart) {
  const Vector x = noise(5000, 11);
  const CrossSpectra spectra = cross_spectra({side_by_side({x, 3.0 * x, noise(5000, 12)})}, kRate, Hertz(1.0)).value();
  EXPECT_TRUE(multiple_coherence(spectra, 2).array().isNaN().all());
}

TEST(SignificantCoherence, IsPassedByChanceInFiveOfAHundredCases) {
  // One input in closed form: P(γ² > c) = (1 − c)^(n − 1).
  EXPECT_NEAR(significant_coherence(11.0, 1), 1.0 - std::pow(0.05, 0.1), 1e-9);
  EXPECT_EQ(significant_coherence(2.0, 2), 1.0);
  for (const Index inputs : {1, 2}) {
    Index passed = 0, lines = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
      Matrix signals(600, inputs + 1);
      for (Index k = 0; k <= inputs; ++k) signals.col(k) = noise(600, 1000 * (seed + 1) + static_cast<unsigned>(k));
      const CrossSpectra spectra = cross_spectra({signals}, kRate, Hertz(1.0)).value();
      const double limit = significant_coherence(spectra.independent_segments, inputs);
      const Matrix coherence = multiple_coherence(spectra, inputs);
      for (Index line = 2; line + 2 < coherence.rows(); ++line, ++lines) passed += coherence(line, 0) > limit ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(passed) / static_cast<double>(lines), 0.05, 0.012) << inputs;
  }
}

TEST(Autocorrelation, IsThatOfAnAutoregressiveProcess) {
  Vector series = noise(200000, 13);
  for (Index i = 1; i < series.size(); ++i) series[i] += 0.8 * series[i - 1];
  const Vector r = autocorrelation({series}, {0, 1, 2, 5, 50});
  EXPECT_EQ(r[0], 1.0);
  EXPECT_NEAR(r[1], 0.8, 0.01);
  EXPECT_NEAR(r[2], 0.64, 0.01);
  EXPECT_NEAR(r[3], std::pow(0.8, 5), 0.02);
  EXPECT_NEAR(r[4], 0.0, 0.02);
}

TEST(Autocorrelation, NeverPairsSamplesAcrossABreak) {
  const Vector a = (Vector(3) << 1.0, 2.0, 3.0).finished(), b = (Vector(2) << 4.0, 5.0).finished();
  const Vector r = autocorrelation({a, b}, {1, 2, 3});
  EXPECT_DOUBLE_EQ(r[0], (2.0 + 6.0 + 20.0) / 55.0);
  EXPECT_DOUBLE_EQ(r[1], 3.0 / 55.0);
  EXPECT_DOUBLE_EQ(r[2], 0.0);
  EXPECT_TRUE(std::isnan(autocorrelation({Vector::Zero(4)}, {0})[0]));
}

}  // namespace
}  // namespace mbk::dsp
