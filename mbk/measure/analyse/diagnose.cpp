#include "mbk/measure/analyse/diagnose.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/dsp/autocorrelation.h"
#include "mbk/base/dsp/integral.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/decimation.h"
#include "mbk/measure/analyse/frequencies.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

constexpr double kLongestLag = 2.0;  ///< of the autocorrelation [s]
constexpr Index kMaxLags = 400;

bool is_known(const impedance::Model& model, Index axes) {
  return model.M.rows() == axes && stacked(model).allFinite();
}

/// −((M + Λ I) ẍ + B ẋ + K (x − x₀)), row by row; Λ is the handle's mass, which is not in M.
Matrix predicted_force(const PreparedTrial& trial, const impedance::Model& model, double handle_mass) {
  const Matrix M = model.M + handle_mass * Matrix::Identity(trial.axes, trial.axes);
  const Matrix offset = trial.position.rowwise() - model.x0.transpose();
  return -(trial.acceleration * M.transpose() + trial.velocity * model.B.transpose() + offset * model.K.transpose());
}

ForcePrediction prediction_of(const PreparedTrial& trial, const Matrix& predicted, const std::vector<Rows>& judged,
                              bool held_out) {
  const Index n = trial.axes;
  Matrix all(trial.time.size(), 3 * n);
  all << trial.force_hand_on_robot, predicted, trial.force_hand_on_robot - predicted;
  const Series shown = decimated(trial.time, all, judged, decimation_of(trial, judged));
  return {held_out, shown.time, shown.values.leftCols(n), shown.values.middleCols(n, n), shown.values.rightCols(n)};
}

/// Where it first falls below 1/e, by a straight line between lags.
double time_constant_of(const Vector& correlation, double sample_time) {
  constexpr double kFallen = 1.0 / std::numbers::e;
  for (Index lag = 1; lag < correlation.size(); ++lag) {
    const double before = correlation[lag - 1], now = correlation[lag];
    if (now < kFallen) return sample_time * (static_cast<double>(lag - 1) + (before - kFallen) / (before - now));
  }
  return kNaN;
}

Autocorrelation autocorrelation_of(const Matrix& residual, const std::vector<Rows>& rows, double sample_time) {
  Index total = 0, longest = 0;
  for (const Rows& one : rows) {
    total += one.size();
    longest = std::max(longest, one.size());
  }
  const Index last = std::min<Index>(std::llround(kLongestLag / sample_time), longest / 4);
  const Index every = std::max<Index>(1, (last + kMaxLags - 1) / kMaxLags);
  const Index count = last / every + 1, n = residual.cols();
  Autocorrelation result{Vector(count), Matrix(count, n), numeric::kNormal95 / std::sqrt(static_cast<double>(total)),
                         Vector(n)};
  for (Index k = 0; k < count; ++k) result.lag[k] = static_cast<double>(k * every) * sample_time;
  for (Index axis = 0; axis < n; ++axis) {
    double mean = 0.0;
    for (const Rows& one : rows) mean += residual.col(axis).segment(one.begin, one.size()).sum();
    mean /= static_cast<double>(total);
    std::vector<Vector> pieces;
    for (const Rows& one : rows) pieces.emplace_back(residual.col(axis).segment(one.begin, one.size()).array() - mean);
    const Vector correlation = dsp::autocorrelation(pieces, last);
    result.value.col(axis) = correlation(Eigen::seqN(0, count, every));
    result.time_constant[axis] = time_constant_of(correlation, sample_time);
  }
  return result;
}

AccelerationAgreement agreement_of(const PreparedTrial& trial, const PreparedTrial& other,
                                   const std::vector<Rows>& rows) {
  const bool own_is_sensor = trial.preparation.acceleration_from_sensor;
  const Index n = trial.axes;
  Matrix both(trial.time.size(), 2 * n);
  both << (own_is_sensor ? other : trial).acceleration, (own_is_sensor ? trial : other).acceleration;
  std::vector<Index> counts;
  for (const Rows& one : rows) {
    for (Index i = one.begin; i < one.end; ++i) counts.push_back(i);
  }
  AccelerationAgreement result{{}, {}, {}, Vector(n), Vector(n)};
  for (Index axis = 0; axis < n; ++axis) {
    const Vector sensor = both.col(n + axis)(counts), difference = sensor - both.col(axis)(counts);
    result.rms_difference[axis] = numeric::root_mean_square(difference.array() - difference.mean());
    result.vaf[axis] = numeric::variance_accounted_for(sensor, difference);
  }
  Series shown = decimated(trial.time, both, rows, decimation_of(trial, rows));
  result.time = std::move(shown.time);
  result.derivative = shown.values.leftCols(n);
  result.sensor = shown.values.rightCols(n);
  return result;
}

/// Less the straight line that fits best.
Vector without_line(const Vector& values) {
  const Index count = values.size();
  const Vector t = Vector::LinSpaced(count, -1.0, 1.0);
  const Vector centred = values.array() - values.mean();
  return count < 2 ? centred : Vector(centred - t * (t.dot(centred) / t.squaredNorm()));
}

DoubleIntegral double_integral_of(const PreparedTrial& trial, const std::vector<Rows>& rows) {
  Rows inner = *std::ranges::max_element(rows, {}, &Rows::size);
  const auto& cutoff = trial.preparation.cutoff;
  const Index end = cutoff ? std::llround(1.0 / (cutoff->value * trial.sample_time)) : 0;
  const Index trim = std::min(end, inner.size() / 4);
  inner.begin += trim;
  inner.end -= trim;
  DoubleIntegral result{Vector(trial.axes), Vector(trial.axes)};
  for (Index axis = 0; axis < trial.axes; ++axis) {
    const auto of = [&](const Matrix& signal) { return Vector(signal.col(axis).segment(inner.begin, inner.size())); };
    const Vector velocity = dsp::cumulative_integral(of(trial.acceleration), trial.sample_time);
    const Vector position = without_line(of(trial.position));
    const Vector difference = position - without_line(dsp::cumulative_integral(velocity, trial.sample_time));
    result.rms_difference[axis] = numeric::root_mean_square(difference);
    result.vaf[axis] = numeric::variance_accounted_for(position, difference);
  }
  return result;
}

void add_recording(const Recording& recording, const Matrix& position, const Matrix& force, Diagnostics& result) {
  const Index n = position.cols();
  const Matrix reference = recorded(recording, kReferenceChannels, static_cast<int>(n));
  Matrix all(recording.samples(), 2 * n + reference.cols());
  all.leftCols(2 * n) << position, force;
  if (reference.cols() > 0) all.rightCols(n) = reference;
  const Vector time = recording.time.array() - recording.time[0];
  Series shown = decimated(time, all, pieces_between_gaps(time), Decimation::extremes);
  result.time = std::move(shown.time);
  result.position = shown.values.leftCols(n);
  result.force = shown.values.middleCols(n, n);
  if (reference.cols() > 0) result.reference = shown.values.rightCols(n);
}

/// What the trial says of the recording that it was made from holds of this one.
Result<void> check_origin(const Matrix& position, const Matrix& force, const PreparedTrial& trial,
                          const std::vector<Rows>& rows) {
  if (position.size() == 0 || force.size() == 0) {
    return bad_data("the recording lacks channels from which the trial was prepared");
  }
  if (rows.empty()) return bad_data("the trial has no rows in the analysed interval");
  const Index every = trial.preparation.every;
  for (const Rows& one : rows) {
    if (one.first_sample + (one.size() - 1) * every >= position.rows()) {
      return bad_data("the recording is shorter than the trial that was prepared from it");
    }
  }
  return {};
}

}  // namespace

Result<Diagnostics> diagnose(const Recording& recording, const PreparedTrial& trial,
                             const Identification& identification, const PreparedTrial* other_acceleration) {
  const Matrix position = recorded(recording, kPositionChannels, trial.axes);
  const Matrix force = recorded(recording, kForceChannels, trial.axes);
  const std::vector<Rows> all = rows_of(trial), held_out = rows_of(trial, Purpose::validation);
  MBK_TRY(check_origin(position, force, trial, all));

  Diagnostics result;
  const double handle = identification.handle_mass;
  const impedance::Model& judged = held_out.empty() ? identification.model : identification.judged;
  if (is_known(judged, trial.axes)) {
    result.prediction = prediction_of(trial, predicted_force(trial, judged, handle), held_out.empty() ? all : held_out,
                                      !held_out.empty());
  }
  Matrix residual;
  if (is_known(identification.model, trial.axes)) {
    residual = trial.force_hand_on_robot - predicted_force(trial, identification.model, handle);
    result.autocorrelation = autocorrelation_of(residual, all, trial.sample_time);
  }
  auto spectra = MBK_TRY(trial_spectra(position, force, trial, residual, all));
  result.spectra = std::move(spectra);
  auto filters = MBK_TRY(filter_response(trial));
  result.filters = std::move(filters);
  if (other_acceleration != nullptr) result.acceleration = agreement_of(trial, *other_acceleration, all);
  result.double_integral = double_integral_of(trial, all);
  add_recording(recording, position, force, result);
  return result;
}

}  // namespace mbk::analyse
