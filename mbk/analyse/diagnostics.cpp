#include "mbk/analyse/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/dsp/butterworth.h"
#include "mbk/dsp/cross_spectrum.h"
#include "mbk/dsp/savitzky_golay.h"
#include "mbk/numeric/statistics.h"

namespace mbk::analyse {
namespace {

constexpr Index kMostRows = 2000;    ///< of a series that is drawn
constexpr double kLongestLag = 2.0;  ///< of the autocorrelation [s]
constexpr Index kMostLags = 400;
constexpr double kSegmentsAcross = 6.0;  ///< segments of a spectrum, end to end; eleven with the overlap
constexpr double kBeyondBand = 5.0;      ///< spectra reach so many times the excited band
constexpr Index kFilterPoints = 240;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Rows {
  Index begin = 0, end = 0;
  [[nodiscard]] Index size() const { return end - begin; }
};

/// The stretches of one purpose, or all; those that follow each other without a break are one.
std::vector<Rows> rows_of(const PreparedTrial& trial, std::optional<Purpose> purpose) {
  std::vector<Rows> rows;
  for (const Stretch& stretch : trial.stretches) {
    if (purpose && stretch.purpose != *purpose) continue;
    const bool follows = !rows.empty() && rows.back().end == stretch.begin &&
                         trial.time[stretch.begin] - trial.time[stretch.begin - 1] < 1.5 * trial.sample_time;
    if (follows) {
      rows.back().end = stretch.end;
    } else {
      rows.push_back({stretch.begin, stretch.end});
    }
  }
  return rows;
}

/// −((M + Λ I) ẍ + B ẋ + K (x − x₀)), row by row.
Matrix predicted_force(const PreparedTrial& trial, const Identification& id) {
  const Index n = trial.axes;
  const Matrix M = id.model.M + id.handle_mass * Matrix::Identity(n, n);
  const Matrix offset = trial.position.rowwise() - id.model.x0.transpose();
  return -(trial.acceleration * M.transpose() + trial.velocity * id.model.B.transpose() +
           offset * id.model.K.transpose());
}

ForcePrediction prediction_of(const PreparedTrial& trial, const Matrix& predicted, const Matrix& residual,
                              const std::vector<Rows>& judged, bool held_back) {
  Index total = 0;
  for (const Rows& rows : judged) total += rows.size();
  const Index every = std::max<Index>(1, (total + kMostRows - 1) / kMostRows);
  std::vector<Index> shown;  // −1: a break
  for (const Rows& rows : judged) {
    if (!shown.empty()) shown.push_back(-1);
    for (Index i = rows.begin; i < rows.end; i += every) shown.push_back(i);
  }
  const auto count = static_cast<Index>(shown.size());
  ForcePrediction result{held_back, Vector(count), Matrix(count, trial.axes), Matrix(count, trial.axes),
                         Matrix(count, trial.axes)};
  for (Index k = 0; k < count; ++k) {
    const Index i = shown[static_cast<std::size_t>(k)];
    if (i < 0) {
      result.time[k] = kNaN;
      for (Matrix* matrix : {&result.measured, &result.predicted, &result.residual}) matrix->row(k).setConstant(kNaN);
      continue;
    }
    result.time[k] = trial.time[i];
    result.measured.row(k) = trial.force_hand_on_robot.row(i);
    result.predicted.row(k) = predicted.row(i);
    result.residual.row(k) = residual.row(i);
  }
  return result;
}

Autocorrelation autocorrelation_of(const Matrix& residual, const std::vector<Rows>& rows, double sample_time) {
  Index total = 0, longest = 0;
  for (const Rows& one : rows) {
    total += one.size();
    longest = std::max(longest, one.size());
  }
  const Index last = std::min(static_cast<Index>(kLongestLag / sample_time), longest / 4);
  const Index every = std::max<Index>(1, (last + kMostLags - 1) / kMostLags);
  std::vector<Index> lags;
  for (Index lag = 0; lag <= last; lag += every) lags.push_back(lag);

  const Index n = residual.cols(), count = static_cast<Index>(lags.size());
  Autocorrelation result{Vector(count), Matrix(count, n), numeric::kNormal95 / std::sqrt(static_cast<double>(total)),
                         Vector::Constant(n, kNaN)};
  for (Index k = 0; k < count; ++k)
    result.lag[k] = static_cast<double>(lags[static_cast<std::size_t>(k)]) * sample_time;
  for (Index axis = 0; axis < n; ++axis) {
    double mean = 0.0;
    for (const Rows& one : rows) mean += residual.col(axis).segment(one.begin, one.size()).sum();
    mean /= static_cast<double>(total);
    std::vector<Vector> pieces;
    for (const Rows& one : rows) pieces.emplace_back(residual.col(axis).segment(one.begin, one.size()).array() - mean);
    result.value.col(axis) = dsp::autocorrelation(pieces, lags);
    for (Index k = 0; k < count; ++k) {
      if (result.value(k, axis) >= 1.0 / std::numbers::e) continue;
      result.time_constant[axis] = result.lag[k];
      break;
    }
  }
  return result;
}

using Names = std::array<const char*, 2>;

/// Recorded channels side by side, or nothing where one is missing.
Matrix recorded(const Recording& recording, int axes, const char* one_axis, const Names& two_axes) {
  Matrix columns(recording.samples(), axes);
  for (Index k = 0; k < axes; ++k) {
    const Channel* channel = recording.find(axes == 1 ? one_axis : two_axes[static_cast<std::size_t>(k)]);
    if (channel == nullptr) return {};
    columns.col(k) = channel->values;
  }
  return columns;
}

/// Values at `wanted`, by straight lines between those at `frequency`; NaN beyond its end.
Vector interpolated(const Vector& frequency, const Vector& values, const Vector& wanted) {
  Vector result = Vector::Constant(wanted.size(), kNaN);
  Index k = 0;
  for (Index i = 0; i < wanted.size(); ++i) {
    while (k + 2 < frequency.size() && frequency[k + 1] < wanted[i]) ++k;
    if (wanted[i] > frequency[frequency.size() - 1]) break;
    const double share = (wanted[i] - frequency[k]) / (frequency[k + 1] - frequency[k]);
    result[i] = (1.0 - share) * values[k] + share * values[k + 1];
  }
  return result;
}

Result<Spectra> spectra_of(const Recording& recording, const Matrix& position, const Matrix& force,
                           const PreparedTrial& trial, const Matrix& residual, const std::vector<Rows>& rows) {
  const Index n = trial.axes;
  const double* const first_time = recording.time.data();
  const auto sample_at = [&](double seconds) {
    const double half = 0.5 / trial.recording_rate;
    return static_cast<Index>(
        std::lower_bound(first_time, first_time + recording.samples(), recording.time[0] + seconds - half) -
        first_time);
  };
  std::vector<Matrix> pieces, residual_pieces;
  Index total = 0, shortest = recording.samples();
  for (const Rows& one : rows) {
    const Index begin = sample_at(trial.time[one.begin]), size = sample_at(trial.time[one.end - 1]) + 1 - begin;
    if (size < 8) continue;
    Matrix piece(size, 2 * n);
    piece << position.middleRows(begin, size), force.middleRows(begin, size);
    pieces.push_back(std::move(piece));
    if (one.size() >= 8) residual_pieces.emplace_back(residual.middleRows(one.begin, one.size()));
    total += size;
    shortest = std::min(shortest, size);
  }
  const Hertz rate(trial.recording_rate);
  const Hertz resolution(kSegmentsAcross * rate.value / static_cast<double>(std::max<Index>(total, 1)));
  const auto cross = dsp::cross_spectra(pieces, rate, resolution);
  if (!cross) return tl::unexpected(cross.error());

  const double top = std::max(kBeyondBand * trial.preparation.band_high.value,
                              trial.preparation.cutoff ? 2.0 * trial.preparation.cutoff->value : 0.0);
  Index lines = 0;
  while (lines < cross->frequency.size() && (lines < 3 || cross->frequency[lines] <= top)) ++lines;
  Spectra result;
  result.frequency = cross->frequency.head(lines);
  result.position.resize(lines, n);
  result.force.resize(lines, n);
  for (Index i = 0; i < lines; ++i) {
    const Vector power = cross->density[static_cast<std::size_t>(i)].diagonal().real();
    result.position.row(i) = power.head(n).transpose();
    result.force.row(i) = power.tail(n).transpose();
  }
  result.coherence = dsp::multiple_coherence(*cross, n).topRows(lines);
  result.coherence_significant = dsp::significant_coherence(cross->independent_segments, n);
  result.segments = cross->segments;
  result.residual = Matrix::Constant(lines, n, kNaN);
  if (residual.size() > 0 && !residual_pieces.empty()) {
    const auto rest = dsp::cross_spectra(residual_pieces, Hertz(1.0 / trial.sample_time), resolution);
    if (!rest) return tl::unexpected(rest.error());
    for (Index axis = 0; axis < n; ++axis) {
      Vector density(rest->frequency.size());
      for (Index i = 0; i < density.size(); ++i) {
        density[i] = rest->density[static_cast<std::size_t>(i)](axis, axis).real();
      }
      result.residual.col(axis) = interpolated(rest->frequency, density, result.frequency);
    }
  }
  return result;
}

Result<FilterResponse> filters_of(const PreparedTrial& trial) {
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
    const auto cascade = dsp::butterworth_lowpass(kLowpassOrder, *how.cutoff, rate);
    if (!cascade) return tl::unexpected(cascade.error());
    for (Index k = 0; k < kFilterPoints; ++k) {
      lowpass[k] = std::pow(dsp::gain(*cascade, Hertz(result.frequency[k]), rate), 2);  // forward and backward
    }
  }
  const std::array<Vector*, 3> gains = {&result.smoothing, &result.first, &result.second};
  for (int derivative = 0; derivative < 3; ++derivative) {
    const auto response = dsp::savitzky_golay_response(smoothing, derivative, result.frequency, rate);
    if (!response) return tl::unexpected(response.error());
    *gains[static_cast<std::size_t>(derivative)] = response->cwiseProduct(lowpass);
  }
  result.first_ideal = 2.0 * std::numbers::pi * result.frequency;
  result.second_ideal = result.first_ideal.cwiseAbs2();
  return result;
}

AccelerationAgreement agreement_of(const PreparedTrial& trial, const PreparedTrial& other,
                                   const std::vector<Rows>& rows) {
  const bool own_is_sensor = trial.preparation.acceleration_from_sensor;
  const Matrix& sensor = own_is_sensor ? trial.acceleration : other.acceleration;
  const Matrix& derivative = own_is_sensor ? other.acceleration : trial.acceleration;
  std::vector<Index> counts;
  for (const Rows& one : rows) {
    for (Index i = one.begin; i < one.end; ++i) counts.push_back(i);
  }
  const Matrix measured = sensor(counts, Eigen::all), difference = measured - derivative(counts, Eigen::all);
  AccelerationAgreement result;
  result.rms_difference.resize(trial.axes);
  result.vaf.resize(trial.axes);
  for (Index axis = 0; axis < trial.axes; ++axis) {
    const Vector centred = difference.col(axis).array() - difference.col(axis).mean();
    result.rms_difference[axis] = numeric::root_mean_square(centred);
    result.vaf[axis] = numeric::variance_accounted_for(measured.col(axis), difference.col(axis));
  }
  std::vector<Index> shown;
  const std::size_t every = std::max<std::size_t>(1, (counts.size() + kMostRows - 1) / kMostRows);
  for (std::size_t k = 0; k < counts.size(); k += every) shown.push_back(counts[k]);
  result.time = trial.time(shown);
  result.derivative = derivative(shown, Eigen::all);
  result.sensor = sensor(shown, Eigen::all);
  return result;
}

/// Two rows for each stretch of samples, which hold its extremes in the order in which they came.
Matrix thinned(const Matrix& columns, Index bucket) {
  if (bucket == 1) return columns;
  const Index buckets = columns.rows() / bucket;
  Matrix rows(2 * buckets, columns.cols());
  for (Index column = 0; column < columns.cols(); ++column) {
    for (Index b = 0; b < buckets; ++b) {
      const auto part = columns.col(column).segment(b * bucket, bucket);
      Index low = 0, high = 0;
      part.minCoeff(&low);
      part.maxCoeff(&high);
      rows(2 * b, column) = part[std::min(low, high)];
      rows(2 * b + 1, column) = part[std::max(low, high)];
    }
  }
  return rows;
}

void add_recording(const Recording& recording, const Matrix& position, const Matrix& force, Diagnostics& result) {
  const Index samples = recording.samples();
  const Index bucket = samples <= kMostRows ? 1 : (2 * samples + kMostRows - 1) / kMostRows;
  result.position = thinned(position, bucket);
  result.force = thinned(force, bucket);
  const Matrix reference =
      recorded(recording, static_cast<int>(position.cols()), "reference", {"reference_x", "reference_y"});
  if (reference.size() > 0) result.reference = thinned(reference, bucket);
  result.time.resize(result.position.rows());
  for (Index i = 0; i < result.time.size(); ++i) {
    const Index sample = bucket == 1 ? i : i / 2 * bucket + i % 2 * (bucket / 2);
    result.time[i] = recording.time[sample] - recording.time[0];
  }
}

}  // namespace

Result<Diagnostics> diagnose(const Recording& recording, const PreparedTrial& trial,
                             const Identification& identification, const PreparedTrial* other_acceleration) {
  const Matrix position = recorded(recording, trial.axes, "position", {"hand_x", "hand_y"});
  const Matrix force = recorded(recording, trial.axes, "reaction", {"force_x", "force_y"});
  if (position.size() == 0 || force.size() == 0) {
    return bad_data("the recording lacks the channels that the trial was prepared from");
  }
  Diagnostics result;
  const std::vector<Rows> all = rows_of(trial, std::nullopt);
  Matrix residual;
  if (stacked(identification.model).allFinite()) {
    const std::vector<Rows> held_back = rows_of(trial, Purpose::validation);
    const Matrix predicted = predicted_force(trial, identification);
    residual = trial.force_hand_on_robot - predicted;
    result.prediction =
        prediction_of(trial, predicted, residual, held_back.empty() ? all : held_back, !held_back.empty());
    result.autocorrelation = autocorrelation_of(residual, all, trial.sample_time);
  }
  auto spectra = spectra_of(recording, position, force, trial, residual, all);
  if (!spectra) return tl::unexpected(spectra.error());
  result.spectra = std::move(*spectra);
  auto filters = filters_of(trial);
  if (!filters) return tl::unexpected(filters.error());
  result.filters = std::move(*filters);
  if (other_acceleration != nullptr) result.acceleration = agreement_of(trial, *other_acceleration, all);
  add_recording(recording, position, force, result);
  return result;
}

}  // namespace mbk::analyse
