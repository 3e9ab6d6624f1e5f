#include "mbk/identify/impedance_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/identify/checks.h"
#include "mbk/identify/regression.h"
#include "mbk/numeric/least_squares.h"

namespace mbk::identify {
namespace {

double largest_relative_change(const impedance::Model& a, const impedance::Model& b) {
  double largest = 0.0;
  for (const auto& [x, y] : {std::pair{&a.M, &b.M}, std::pair{&a.B, &b.B}, std::pair{&a.K, &b.K}}) {
    const double scale = x->cwiseAbs().maxCoeff();
    if (scale > 0.0) largest = std::max(largest, (*y - *x).cwiseAbs().maxCoeff() / scale);
  }
  return largest;
}

}  // namespace

std::vector<std::string> parameter_names(int axes) {
  if (axes == 1) return {"m", "b", "k", "x0"};
  std::vector<std::string> names;
  for (const char matrix : {'m', 'b', 'k'}) {
    for (const char* entry : {"xx", "xy", "yx", "yy"}) names.push_back(fmt::format("{}_{}", matrix, entry));
  }
  names.insert(names.end(), {"x0", "y0"});
  return names;
}

Result<Identification> identify_impedance(const std::vector<PreparedTrial>& trials, const Options& options) {
  if (trials.empty()) return bad_usage("no trial to identify from");
  if (!(options.hac_lag_s >= 0.0 && std::isfinite(options.hac_lag_s))) {
    return bad_usage(
        fmt::format("a reach of the residual's correlation of {:g} s is not 0 or more", options.hac_lag_s));
  }
  if (!std::isfinite(options.handle_mass)) {
    return bad_usage(fmt::format("a handle mass of {:g} kg is none", options.handle_mass));
  }
  const PreparedTrial& first = trials.front();
  for (const PreparedTrial& trial : trials) {
    if (trial.axes != first.axes || trial.motion != first.motion) {
      return bad_data("its axes or units are not those of the first file, so they cannot be pooled",
                      "measure it by itself", trial.sources.empty() ? "" : trial.sources.front().path);
    }
    if (std::abs(trial.sample_time - first.sample_time) > 1e-6 * first.sample_time) {
      return bad_data(
          fmt::format("trials of {:g} Hz and {:g} Hz cannot be pooled", first.recording_rate, trial.recording_rate),
          "put them on one clock with --resample HZ");
    }
  }
  Regression r = stack(trials);
  if (r.identification.empty()) return bad_data("no data to identify from", "move --split to a later time");
  const Index n = r.axes();
  const Matrix S = structure_matrix(options.structure, n);

  const auto fit_rows = [&](const std::vector<RowRange>& ranges, Index step) {
    return numeric::fit_least_squares(rows_of(r.Z, ranges, step), rows_of(r.Y, ranges, step), S);
  };
  const auto check = fit_rows(r.identification, 1);
  if (!check) return tl::unexpected(check.error());

  Identification result;
  result.axes = first.axes;
  result.motion = first.motion;
  result.structure = options.structure;
  result.handle_mass = options.handle_mass;
  result.fit = judge(r, check->coefficients);

  const bool pulses_by_default =
      first.preparation.mode == Mode::improved && first.preparation.protocol == Protocol::underdamped;
  const ParametersFrom from =
      options.parameters_from.value_or(pulses_by_default ? ParametersFrom::all : ParametersFrom::identification);
  const bool all = from == ParametersFrom::all;
  result.parameters_from = all ? "all" : "identification";
  const std::vector<RowRange> ranges = all ? joined(r.identification, r.validation) : joined(r.identification, {});
  const auto fit = all && !r.validation.empty() ? fit_rows(ranges, 1) : check;
  if (!fit) return tl::unexpected(fit.error());

  result.parameters = parameter_names(first.axes);
  for (const RowRange& range : ranges) result.samples += range.size();
  const double data_s = static_cast<double>(result.samples) * r.sample_time;
  if (options.hac_lag_s > std::max(data_s, Options{}.hac_lag_s)) {
    return bad_usage(fmt::format("--hac-lag {:g} s reaches beyond the {:.3g} s of data", options.hac_lag_s, data_s),
                     "choose a shorter one; the residual's correlation seldom lasts for a second");
  }
  const auto lags = static_cast<Index>(std::llround(options.hac_lag_s / r.sample_time));
  result.hac_lag_s = static_cast<double>(lags) * r.sample_time;
  // The coefficients of smallest norm explain the force too, but they are not the limb's.
  const auto model_from = [&](const numeric::LinearFit& one) {
    const Vector undefined = Vector::Constant(3 * n * n + n, std::numeric_limits<double>::quiet_NaN());
    return one.rank == r.Z.cols() ? model_of(one.coefficients, r.centre, options.handle_mass)
                                  : impedance::unstacked(undefined, n);
  };
  result.model = model_from(*fit);
  result.judged = model_from(*check);
  if (fit->rank == r.Z.cols()) {
    const Matrix residual = r.Y - r.Z * fit->coefficients;
    const double widening =
        numeric::newey_west_widening(static_cast<double>(lags) / static_cast<double>(result.samples));
    const Matrix V = widening * widening * numeric::newey_west_covariance(*fit, r.Z, residual, ranges, lags);
    result.covariance = model_covariance(fit->structure, V, result.model, r.centre);
  } else {
    const auto count = static_cast<Index>(result.parameters.size());
    result.covariance.setConstant(count, count, std::numeric_limits<double>::quiet_NaN());
  }
  result.standard_error = impedance::unstacked(result.covariance.diagonal().cwiseSqrt(), n);

  for (const PreparedTrial& trial : trials) {
    result.preparations.push_back(trial.preparation);
    result.sources.insert(result.sources.end(), trial.sources.begin(), trial.sources.end());
    result.durations.insert(result.durations.end(), trial.sources.size(), trial.recording_duration);
    result.rates.insert(result.rates.end(), trial.sources.size(), trial.recording_rate);
    result.notes.insert(result.notes.end(), trial.notes.begin(), trial.notes.end());
    result.warnings.insert(result.warnings.end(), trial.warnings.begin(), trial.warnings.end());
  }
  result.excitation = measure_excitation(rows_of(r.Z, ranges), rows_of(r.Y, ranges), result.model, fit->rank);
  result.excitation.duration = static_cast<double>(result.samples) * r.sample_time;

  if (options.decimate_check) {
    // At least every other one: the rows may be thinned already.
    const auto step = std::max<Index>(2, static_cast<Index>(std::llround(1.0 / (100.0 * r.sample_time))));
    const auto coarse = fit_rows(ranges, step);
    if (!coarse) return tl::unexpected(coarse.error());
    DecimationCheck decimation;
    decimation.rate_hz = 1.0 / (static_cast<double>(step) * r.sample_time);
    decimation.model = model_of(coarse->coefficients, r.centre, options.handle_mass);
    decimation.largest_change = largest_relative_change(result.model, decimation.model);
    result.decimation = decimation;
  }
  add_warnings(result);
  return result;
}

}  // namespace mbk::identify
