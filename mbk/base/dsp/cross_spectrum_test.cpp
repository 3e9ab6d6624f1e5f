#include "mbk/base/dsp/cross_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "mbk/base/dsp/spectrum.h"

namespace mbk::dsp {
namespace cross_spectrum_test {

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
  const CrossSpectra spectra = cross_spectra({signals}, kRate, 200).value();
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
  const CrossSpectra spectra = cross_spectra({signals}, kRate, n).value();
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

TEST(CrossSpectra, AreTheSameWhereTheUpperLinesAreLeftOut) {
  const Matrix signals = side_by_side({noise(3000, 5), noise(3000, 6)});
  const CrossSpectra all = cross_spectra({signals}, kRate, 200).value();
  const double spacing = all.frequency[1];
  for (const double highest : {0.0, 0.4 * spacing, 7.5 * spacing, 0.5 * kRate.value, kRate.value}) {
    const CrossSpectra some = cross_spectra({signals}, kRate, 200, Hertz(highest)).value();
    const Index lines = some.frequency.size();
    ASSERT_EQ(std::ssize(some.density), lines);
    EXPECT_EQ(lines, highest < spacing ? 2 : highest < 8.0 * spacing ? 8 : 101) << highest;
    EXPECT_EQ(some.independent_segments, all.independent_segments);
    for (Index line = 0; line < lines; ++line) {
      EXPECT_NEAR(some.frequency[line], all.frequency[line], 1e-12 * kRate.value);
      EXPECT_EQ(some.density[static_cast<std::size_t>(line)], all.density[static_cast<std::size_t>(line)]);
    }
  }
}

TEST(CrossSpectra, NeverReachAcrossABreak) {
  // Two pieces whose means differ by far: a segment across the break would see a step.
  const Vector quiet = 1e-6 * noise(400, 5);
  const Matrix low = side_by_side({quiet}), high = (low.array() + 1000.0).matrix();
  const CrossSpectra spectra = cross_spectra({low, high}, kRate, 100).value();
  for (const Eigen::MatrixXcd& density : spectra.density) EXPECT_LT(density(0, 0).real(), 1e-10);
  EXPECT_EQ(spectra.segments, 14);
}

TEST(CrossSpectra, LeaveOutPiecesShorterThanASegment) {
  const Matrix whole = noise(300, 21), scrap = 1000.0 * noise(99, 22);
  const CrossSpectra with = cross_spectra({scrap, whole, scrap}, kRate, 100).value(),
                     without = cross_spectra({whole}, kRate, 100).value();
  EXPECT_EQ(with.segments, without.segments);
  EXPECT_EQ(with.density[20], without.density[20]);
}

TEST(CrossSpectra, VaryAsMuchAsTheIndependentSegmentsSay) {
  // A periodogram of white noise has a standard deviation of its own size; the mean of n of them 1/√n of that.
  const CrossSpectra spectra = cross_spectra({Matrix(noise(550 * 2, 23)), Matrix(noise(550, 24))}, kRate, 100).value();
  EXPECT_EQ(spectra.segments, 31);
  EXPECT_NEAR(spectra.independent_segments, 31.0 / (1.0 + 2.0 / 36.0 * 29.0 / 31.0), 1e-12);
  double squares = 0.0, independent = 0.0, lines = 0.0;
  const double density = 2.0 / kRate.value;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const auto some = cross_spectra({Matrix(noise(1600, 500 + seed))}, kRate, 100).value();
    independent = some.independent_segments;
    for (std::size_t line = 2; line < 49; ++line, ++lines) {
      squares += std::pow(some.density[line](0, 0).real() / density - 1.0, 2);
    }
  }
  constexpr double kChance = 0.06;  // 9400 lines, a third of them independent: √(2/3100) = 2.5 % of the variance
  EXPECT_NEAR(squares / lines * independent, 1.0, kChance);
}

TEST(CrossSpectra, RefuseTooLittle) {
  EXPECT_FALSE(cross_spectra({}, kRate, 8));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(7, 2)}, kRate, 8));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(100, 2)}, kRate, 102));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(100, 2)}, kRate, 99));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(100, 2)}, kRate, 6));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(100, 2), Matrix::Zero(100, 1)}, kRate, 100));
  EXPECT_FALSE(cross_spectra({Matrix::Zero(100, 2)}, Hertz(0.0), 100));
  EXPECT_TRUE(cross_spectra({Matrix::Zero(8, 2)}, kRate, 8));
}

/// Sums of integers modulo a prime: the same in every language, so that SciPy could be given them.
Matrix numbers_for_scipy(Index samples) {
  Matrix signals(samples, 3);
  std::int64_t state = 1;
  const auto next = [&] {
    state = state * 48271 % 2147483647;
    return static_cast<double>(state) / 2147483647.0 - 0.5;
  };
  double x = 0.0, y = 0.0;
  for (Index i = 0; i < samples; ++i) {
    const double before = x;
    x = 0.9 * x + next();
    y = 0.5 * y + 0.3 * x + next();
    signals.row(i) << x, y, 2.0 * x - before + 0.5 * y + next();
  }
  return signals;
}

TEST(CrossSpectra, AgreeWithSciPy) {
  // scipy.signal.csd and coherence (1.10.1), window 'hann', nperseg 120, noverlap 60, detrend 'constant'; S_jk is
  // csd(k, j). Multiple coherence from csd by numpy.linalg.solve.
  constexpr double kDigits = 1e-12;
  const Matrix signals = numbers_for_scipy(1000);
  const CrossSpectra spectra = cross_spectra({signals}, kRate, 120).value(),
                     one = cross_spectra({signals(Eigen::all, std::vector{0, 2})}, kRate, 120).value();
  struct Line {
    std::size_t line;
    double power;
    std::complex<double> cross;
    double ordinary, multiple;
  };
  for (const Line& want :
       {Line{7,
             0.019136089601080042,
             {0.013183107621681078, -0.0018107195193952262},
             0.9129460444902098,
             0.9443280214941583},
        Line{30,
             0.006829483407468375,
             {0.002004836714366652, -0.00028818881574362015},
             0.7493751671064124,
             0.8106593115550593},
        Line{60, 0.004274149418921057, {0.0011004415386236773, 0.0}, 0.8659830306882518, 0.8972700652416822}}) {
    const auto row = static_cast<Index>(want.line);
    EXPECT_NEAR(spectra.density[want.line](2, 2).real(), want.power, kDigits * want.power);
    EXPECT_LT(std::abs(spectra.density[want.line](0, 2) - want.cross), kDigits * want.power);
    EXPECT_NEAR(multiple_coherence(one, 1)(row, 0), want.ordinary, kDigits);
    EXPECT_NEAR(multiple_coherence(spectra, 2)(row, 0), want.multiple, kDigits);
  }
  EXPECT_NEAR(spectra.frequency[7], 5.833333333333334, kDigits);
}

TEST(MultipleCoherence, IsOneForALinearRelationAndTheShareOfPowerWithNoise) {
  const Index n = 60000;
  const Vector x = noise(n, 6), y = noise(n, 7), e = noise(n, 8);
  const Vector exact = 2.0 * x - 0.5 * y, noisy = 2.0 * x + y + e;  // 5 of 6 parts of the power
  const CrossSpectra spectra = cross_spectra({side_by_side({x, y, exact, noisy})}, kRate, 100).value();
  const Matrix coherence = multiple_coherence(spectra, 2);
  EXPECT_GT(coherence.col(0).minCoeff(), 1.0 - 1e-9);
  EXPECT_NEAR(coherence.col(1).mean(), 5.0 / 6.0, 0.005);
  EXPECT_GE(coherence.minCoeff(), 0.0);
  EXPECT_LE(coherence.maxCoeff(), 1.0);
}

TEST(MultipleCoherence, SeesWhatOneInputAloneDoesNot) {
  const Index n = 20000;
  const Vector x = noise(n, 9), y = noise(n, 10);
  const CrossSpectra both = cross_spectra({side_by_side({x, y, x + y})}, kRate, 100).value(),
                     one = cross_spectra({side_by_side({x, x + y})}, kRate, 100).value();
  EXPECT_GT(multiple_coherence(both, 2).minCoeff(), 1.0 - 1e-9);
  EXPECT_NEAR(multiple_coherence(one, 1).mean(), 0.5, 0.02);
}

TEST(MultipleCoherence, DependsOnNoUnit) {
  const Index n = 4000;
  const Vector x = noise(n, 31), y = noise(n, 32), e = noise(n, 33);
  const Matrix plain = multiple_coherence(cross_spectra({side_by_side({x, y, x + y + e})}, kRate, 100).value(), 2);
  const Matrix scaled =
      multiple_coherence(cross_spectra({side_by_side({1e-9 * x, 1e6 * y, 1e3 * (x + y + e)})}, kRate, 100).value(), 2);
  EXPECT_LT((plain - scaled).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(MultipleCoherence, IsOneOfASignalWithItself) {
  const Vector x = noise(2000, 34);
  EXPECT_NEAR(multiple_coherence(cross_spectra({side_by_side({x, x})}, kRate, 100).value(), 1).minCoeff(), 1.0, 1e-12);
}

TEST(MultipleCoherence, IsUndefinedWhereInputsCannotBeToldApart) {
  const Vector x = noise(5000, 11);
  const CrossSpectra spectra = cross_spectra({side_by_side({x, 3.0 * x, noise(5000, 12)})}, kRate, 100).value();
  EXPECT_TRUE(multiple_coherence(spectra, 2).array().isNaN().all());
  const CrossSpectra still = cross_spectra({side_by_side({x, Vector::Zero(5000), x})}, kRate, 100).value();
  EXPECT_TRUE(multiple_coherence(still, 2).array().isNaN().all());
}

TEST(SignificantCoherence, IsPassedByChanceInFiveOfAHundredCases) {
  // One input in closed form: P(γ² > c) = (1 − c)^(n − 1).
  EXPECT_NEAR(significant_coherence(11.0, 1), 1.0 - std::pow(0.05, 0.1), 1e-9);
  EXPECT_NEAR(significant_coherence(10.4, 2), 0.4144461676973789, 1e-9);  // scipy.stats.beta(2, 8.4).isf(0.05)
  EXPECT_EQ(significant_coherence(2.0, 2), 1.0);
  for (const Index inputs : {1, 2}) {
    Index passed = 0, lines = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
      Matrix signals(600, inputs + 1);
      for (Index k = 0; k <= inputs; ++k) signals.col(k) = noise(600, 1000 * (seed + 1) + static_cast<unsigned>(k));
      const CrossSpectra spectra = cross_spectra({signals}, kRate, 100).value();
      const double limit = significant_coherence(spectra.independent_segments, inputs);
      const Matrix coherence = multiple_coherence(spectra, inputs);
      for (Index line = 2; line + 2 < coherence.rows(); ++line, ++lines) passed += coherence(line, 0) > limit ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(passed) / static_cast<double>(lines), 0.05, 0.012) << inputs;
  }
}

}  // namespace cross_spectrum_test
}  // namespace mbk::dsp
