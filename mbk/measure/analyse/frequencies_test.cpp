#include "mbk/measure/analyse/frequencies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace mbk::analyse {
namespace frequencies_test {

constexpr double kRate = 1000.0;

Vector noise(Index samples, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Vector values(samples);
  for (double& value : values) value = normal(random);
  return values;
}

/// Segments of N rows, of which each stands for `every` samples; a break lies between two.
PreparedTrial trial_of(const std::vector<Index>& sizes, Index every) {
  PreparedTrial trial;
  trial.axes = 1;
  trial.recording_rate = kRate;
  trial.sample_time = static_cast<double>(every) / kRate;
  trial.preparation.every = every;
  trial.preparation.band_low = Hertz(0.3);
  trial.preparation.band_high = Hertz(3.0);
  trial.preparation.cutoff = Hertz(5.0);
  Index row = 0;
  for (const Index size : sizes) {
    trial.segments.push_back({row, row + size, Purpose::identification, row * every});
    row += size + 5;
  }
  trial.time = Vector::LinSpaced(row, 0.0, static_cast<double>(row - 1) * trial.sample_time);
  return trial;
}

Spectra spectra_of(const PreparedTrial& trial, const Vector& position, const Vector& force,
                   const Matrix& residual = {}) {
  return trial_spectra(position, force, trial, residual, rows_of(trial)).value();
}

TEST(TrialSpectra, HaveElevenSegmentsWithTheDensitiesOfWhatWasRecorded) {
  const PreparedTrial trial = trial_of({3000}, 20);
  const Vector x = 0.1 * noise(60200, 1), e = noise(60200, 2);
  const Vector force = 30.0 * x + e;  // nine of ten parts of its power
  const Spectra spectra = spectra_of(trial, x, force);
  EXPECT_EQ(spectra.segments, 11);
  EXPECT_LE(spectra.frequency[spectra.frequency.size() - 1], 15.0);  // five times the band
  EXPECT_GT(spectra.frequency[spectra.frequency.size() - 1], 14.8);
  // White: 2σ²/rate; over 120 lines of eleven segments to 3 %.
  EXPECT_NEAR(spectra.position.mean(), 2.0 * 0.01 / kRate, 0.1 * 2.0 * 0.01 / kRate);
  EXPECT_NEAR(spectra.force.mean(), 2.0 * 10.0 / kRate, 0.1 * 2.0 * 10.0 / kRate);
  EXPECT_NEAR(spectra.coherence.mean(), 0.9, 0.03);
  EXPECT_EQ(spectra.residual.size(), 0);
  EXPECT_NEAR(spectra.coherence_significant, 0.27, 0.02);  // 1 − 0.05^(1/(n − 1)), n = 10.5
}

TEST(TrialSpectra, HaveTheResidualAtTheSameLines) {
  // A sine at one line, in the rows of the residual and in the recording: the same height at the same place.
  for (const Index every : {1, 7, 20}) {
    const Index rows = 42000 / every;
    const PreparedTrial trial = trial_of({rows}, every);
    Vector recorded(rows * every);
    const double hz = spectra_of(trial, noise(rows * every, 3), noise(rows * every, 4)).frequency[16];
    for (Index i = 0; i < recorded.size(); ++i) {
      recorded[i] = std::sin(2.0 * std::numbers::pi * hz * static_cast<double>(i) / kRate);
    }
    Matrix residual = Matrix::Zero(trial.time.size(), 1);
    for (Index i = 0; i < rows; ++i) residual(i, 0) = recorded[i * every];
    const Spectra spectra = spectra_of(trial, noise(rows * every, 3), recorded, residual);
    ASSERT_EQ(spectra.residual.rows(), spectra.frequency.size());
    EXPECT_NEAR(spectra.residual(16, 0) / spectra.force(16, 0), 1.0, 1e-9) << every;
    EXPECT_NEAR(spectra.residual.sum() * spectra.frequency[1], 0.5, 1e-6) << every;
  }
}

TEST(TrialSpectra, OfTheResidualAreUnknownBeyondHalfTheRateOfItsRows) {
  PreparedTrial trial = trial_of({1500}, 40);  // rows at 25 Hz, drawn up to 15 Hz
  const Spectra spectra = spectra_of(trial, noise(62000, 5), noise(62000, 6), Matrix(noise(trial.time.size(), 7)));
  for (Index i = 0; i < spectra.frequency.size(); ++i) {
    EXPECT_EQ(std::isnan(spectra.residual(i, 0)), spectra.frequency[i] > 12.5 + 1e-9) << spectra.frequency[i];
  }
}

TEST(TrialSpectra, NeverReachAcrossABreakAndAreNotShortenedByAScrap) {
  const PreparedTrial trial = trial_of({300, 12, 280, 310}, 5);
  Vector force = noise(5000, 8);
  force.segment(0, 1500).array() += 1000.0;  // whoever joins two segments sees a step
  const Spectra spectra = spectra_of(trial, noise(5000, 9), force);
  EXPECT_LT(spectra.force.maxCoeff(), 0.1);
  EXPECT_NEAR(spectra.frequency[1], 200.0 / 144.0, 1e-9);  // 898 intervals over six, made of small factors
  EXPECT_EQ(spectra.segments, 3 + 2 + 3);
}

TEST(TrialSpectra, TakeMoreSegmentsWhereTheBandIsWide) {
  PreparedTrial trial = trial_of({60000}, 1);
  trial.preparation.band_high = Hertz(48.0);
  const Spectra spectra = spectra_of(trial, noise(60100, 10), noise(60100, 11));
  EXPECT_NEAR(spectra.frequency[1], 0.5, 0.01);  // 96 lines in the band
  EXPECT_EQ(spectra.segments, 59);
  EXPECT_LT((spectra.coherence.array() > spectra.coherence_significant).cast<double>().mean(), 0.09);
}

TEST(TrialSpectra, AreEmptyWhereNoSegmentIsLongEnough) {
  const Spectra spectra = spectra_of(trial_of({8, 3}, 2), noise(60, 12), noise(60, 13));
  EXPECT_EQ(spectra.frequency.size(), 0);
  EXPECT_EQ(spectra.segments, 0);
  EXPECT_EQ(spectra_of(trial_of({9, 3}, 2), noise(60, 12), noise(60, 13)).segments, 1);
}

TEST(FilterResponse, IsWhatTheFiltersOfTheThesisDo) {
  // Fig. 3.5, (6, 101) at 1 kHz and 5 Hz: forward and backward 1/2 at the cutoff, times the smoothing, which is 1
  // there.
  PreparedTrial trial = trial_of({1000}, 1);
  trial.preparation.smoothing_order = 6;
  trial.preparation.smoothing_window = 101;
  const FilterResponse filters = filter_response(trial).value();
  Index at = 0;
  (filters.frequency.array() - 5.0).abs().minCoeff(&at);
  const double f = filters.frequency[at];
  // |H|² of a Butterworth of order five; the bilinear transform changes 1e-4 of it so far below the rate.
  const double lowpass = 1.0 / (1.0 + std::pow(f / 5.0, 10));
  EXPECT_NEAR(filters.smoothing[at], lowpass, 1e-3);
  EXPECT_NEAR(filters.first[at], 2.0 * std::numbers::pi * f * lowpass, 1e-3 * filters.first_ideal[at]);
  EXPECT_NEAR(filters.second[at], std::pow(2.0 * std::numbers::pi * f, 2) * lowpass, 2e-3 * filters.second_ideal[at]);
  EXPECT_NEAR(filters.frequency[0], 0.1, 1e-12);  // the band's lower end is 0.3 Hz
  EXPECT_NEAR(filters.frequency[filters.frequency.size() - 1], 450.0, 1e-9);
  EXPECT_LT(filters.smoothing.tail(40).maxCoeff(), 1e-12);
}

TEST(FilterResponse, IsTheSmoothingAloneWithoutALowpass) {
  PreparedTrial trial = trial_of({1000}, 1);
  trial.preparation.cutoff.reset();
  const FilterResponse filters = filter_response(trial).value();
  Index at = 0;
  (filters.frequency.array() - 10.0).abs().minCoeff(&at);
  EXPECT_NEAR(filters.smoothing[at], 1.0, 0.02);
}

}  // namespace frequencies_test
}  // namespace mbk::analyse
