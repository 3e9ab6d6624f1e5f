#include "mbk/measure/analyse/frequencies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "mbk/base/dsp/butterworth.h"
#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/dsp/spectrum.h"

namespace mbk::analyse {
namespace {

constexpr double kSegmentsAcross = 6.0;  ///< segments of a spectrum, end to end; eleven with the overlap
constexpr double kLinesInBand = 96.0;
constexpr double kBeyondBand = 5.0;  ///< spectra reach so many times the excited band
constexpr Index kMinRows = 9;        ///< of a piece: a segment of eight, and the part of a row at its end
constexpr Index kFilterPoints = 240;

/// The longest that a segment may be: pieces of half the longest or more count whole, shorter ones are left out rather
/// than that they shorten the segments of all.
Index longest_segment(const std::vector<Rows>& rows) {
  Index longest = 0, shortest = std::numeric_limits<Index>::max();
  for (const Rows& one : rows) longest = std::max(longest, one.size());
  for (const Rows& one : rows) {
    if (2 * one.size() >= longest) shortest = std::min(shortest, one.size());
  }
  return longest < kMinRows ? 0 : std::max(shortest, kMinRows) - 1;
}

/// [rows] of the trial that one segment takes; 0 where there are too few.
Index segment_of(const PreparedTrial& trial, const std::vector<Rows>& rows) {
  const Index longest = longest_segment(rows);
  if (longest == 0) return 0;
  Index total = 0;
  for (const Rows& one : rows) total += one.size() - 1;  // whole rows: behind the last there is one sample of it
  const Hertz rate(1.0 / trial.sample_time);
  const double finest = kSegmentsAcross * rate.value / static_cast<double>(std::max<Index>(total, 1));
  return dsp::segment_length(rate, Hertz(std::max(finest, trial.preparation.band_high.value / kLinesInBand)), longest);
}

/// The power of the signals from `first` on at the first so many lines.
Matrix powers(const dsp::CrossSpectra& spectra, Index first, Index signals, Index lines) {
  Matrix power = Matrix::Constant(lines, signals, std::numeric_limits<double>::quiet_NaN());
  for (Index line = 0; line < std::min(lines, spectra.frequency.size()); ++line) {
    power.row(line) =
        spectra.density[static_cast<std::size_t>(line)].diagonal().segment(first, signals).real().transpose();
  }
  return power;
}

}  // namespace

Result<Spectra> trial_spectra(const Matrix& position, const Matrix& force, const PreparedTrial& trial,
                              const Matrix& residual, const std::vector<Rows>& rows) {
  const Index n = trial.axes, every = trial.preparation.every, segment = segment_of(trial, rows);
  if (segment == 0) return Spectra{};
  std::vector<Matrix> recorded, left;
  for (const Rows& one : rows) {
    const Index size = (one.size() - 1) * every + 1;
    Matrix piece(size, 2 * n);
    piece << position.middleRows(one.first_sample, size), force.middleRows(one.first_sample, size);
    recorded.push_back(std::move(piece));
    if (residual.size() > 0) left.emplace_back(residual.middleRows(one.begin, one.size()));
  }
  const auto cross = MBK_TRY(dsp::cross_spectra(recorded, Hertz(trial.recording_rate), segment * every));

  const Preparation& how = trial.preparation;
  const double top = std::max(kBeyondBand * how.band_high.value, how.cutoff ? 2.0 * how.cutoff->value : 0.0);
  Index lines = 0;
  while (lines < cross.frequency.size() && (lines < 3 || cross.frequency[lines] <= top)) ++lines;
  Spectra result;
  result.frequency = cross.frequency.head(lines);
  result.position = powers(cross, 0, n, lines);
  result.force = powers(cross, n, n, lines);
  result.coherence = dsp::multiple_coherence(cross, n).topRows(lines);
  result.coherence_significant = dsp::significant_coherence(cross.independent_segments, n);
  result.segments = cross.segments;
  if (left.empty()) return result;
  const auto rest = MBK_TRY(dsp::cross_spectra(left, Hertz(1.0 / trial.sample_time), segment));
  result.residual = powers(rest, 0, n, lines);
  return result;
}

Result<FilterResponse> filter_response(const PreparedTrial& trial) {
  const Preparation& how = trial.preparation;
  const Hertz rate(trial.recording_rate);
  const dsp::SavitzkyGolay smoothing{how.smoothing_order, how.smoothing_window};
  const double low = 0.1 * std::max(how.band_low.value, 1e-3 * rate.value), high = 0.45 * rate.value;
  FilterResponse result;
  result.frequency.resize(kFilterPoints);
  for (Index k = 0; k < kFilterPoints; ++k) {
    result.frequency[k] = low * std::pow(high / low, static_cast<double>(k) / static_cast<double>(kFilterPoints - 1));
  }
  Vector lowpass = Vector::Ones(kFilterPoints);
  if (how.cutoff) {
    const auto cascade = MBK_TRY(dsp::butterworth_lowpass(kLowpassOrder, *how.cutoff, rate));
    for (Index k = 0; k < kFilterPoints; ++k) {
      lowpass[k] = std::pow(dsp::gain(cascade, Hertz(result.frequency[k]), rate), 2);  // forward and backward
    }
  }
  const std::array<Vector*, 3> gains = {&result.smoothing, &result.first, &result.second};
  for (int derivative = 0; derivative < 3; ++derivative) {
    const auto response = MBK_TRY(dsp::savitzky_golay_response(smoothing, derivative, result.frequency, rate));
    *gains[static_cast<std::size_t>(derivative)] = response.cwiseProduct(lowpass);
  }
  result.first_ideal = 2.0 * std::numbers::pi * result.frequency;
  result.second_ideal = result.first_ideal.cwiseAbs2();
  return result;
}

}  // namespace mbk::analyse
