#include "mbk/identify/impedance_fit.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/identify/checks.h"
#include "mbk/numeric/least_squares.h"
#include "mbk/numeric/statistics.h"

namespace mbk::identify {
namespace {

using numeric::RowRange;

/// −F on [ẍ ẋ x−x̄ 1]; positions are measured from their mean, which costs no digits and changes nothing else.
struct Regression {
  Matrix Z;       ///< N×(3n+1)
  Matrix Y;       ///< N×n, −F_h
  Vector centre;  ///< x̄, n
  std::vector<RowRange> identification, validation;
  double sample_time = 0;

  [[nodiscard]] Index axes() const { return Y.cols(); }
};

std::vector<RowRange> joined(const std::vector<RowRange>& a, const std::vector<RowRange>& b) {
  std::vector<RowRange> all = a;
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end(), [](const RowRange& x, const RowRange& y) { return x.begin < y.begin; });
  // Neighbours without a break in between are one range: the residual's correlation does not stop at the split.
  std::vector<RowRange> merged;
  for (const RowRange& range : all) {
    if (!merged.empty() && merged.back().end == range.begin) {
      merged.back().end = range.end;
    } else {
      merged.push_back(range);
    }
  }
  return merged;
}

/// The stretches of all trials under each other; rows that do not count are left out. A break in time always starts a
/// new range, and where two stretches follow each other without one, `joined` may merge them.
Regression stack(const std::vector<PreparedTrial>& trials) {
  const Index n = trials.front().axes;
  Index rows = 0;
  for (const PreparedTrial& trial : trials) {
    for (const Stretch& stretch : trial.stretches) rows += stretch.size() + 1;
  }
  Regression r;
  r.sample_time = trials.front().sample_time;
  r.Z.setZero(rows, 3 * n + 1);
  r.Y.setZero(rows, n);
  Index row = 0;
  for (const PreparedTrial& trial : trials) {
    Index last_end = -1;
    for (const Stretch& stretch : trial.stretches) {
      const Index size = stretch.size();
      const bool broken = stretch.begin != last_end ||
                          trial.time[stretch.begin] - trial.time[stretch.begin - 1] > 1.5 * trial.sample_time;
      if (row > 0 && broken) ++row;  // an empty row keeps the ranges apart; it belongs to none
      last_end = stretch.end;
      r.Z.block(row, 0, size, n) = trial.acceleration.middleRows(stretch.begin, size);
      r.Z.block(row, n, size, n) = trial.velocity.middleRows(stretch.begin, size);
      r.Z.block(row, 2 * n, size, n) = trial.position.middleRows(stretch.begin, size);
      r.Z.block(row, 3 * n, size, 1).setOnes();
      r.Y.middleRows(row, size) = -trial.force_hand_on_robot.middleRows(stretch.begin, size);
      (stretch.purpose == Purpose::identification ? r.identification : r.validation).push_back({row, row + size});
      row += size;
    }
  }
  r.Z.conservativeResize(row, Eigen::NoChange);
  r.Y.conservativeResize(row, Eigen::NoChange);
  r.centre = Vector::Zero(n);
  Index count = 0;
  for (const RowRange& range : r.identification.empty() ? r.validation : r.identification) {
    r.centre += r.Z.block(range.begin, 2 * n, range.size(), n).colwise().sum().transpose();
    count += range.size();
  }
  r.centre /= static_cast<double>(std::max<Index>(count, 1));
  for (const RowRange& range : joined(r.identification, r.validation)) {
    r.Z.block(range.begin, 2 * n, range.size(), n).rowwise() -= r.centre.transpose();
  }
  return r;
}

/// Every `step`-th row of the ranges, under each other.
Matrix rows_of(const Matrix& all, const std::vector<RowRange>& ranges, Index step = 1) {
  Index count = 0;
  for (const RowRange& range : ranges) count += (range.size() + step - 1) / step;
  Matrix rows(count, all.cols());
  Index row = 0;
  for (const RowRange& range : ranges) {
    for (Index i = range.begin; i < range.end; i += step) rows.row(row++) = all.row(i);
  }
  return rows;
}

/// θ = S φ with θ_j = [row j of M, row j of B, row j of K, c_j] stacked over the outputs j.
Matrix structure_matrix(Structure structure, Index n) {
  const Index p = 3 * n + 1;
  if (structure == Structure::full || (structure == Structure::symmetric && n == 1)) {
    return Matrix::Identity(n * p, n * p);
  }
  std::vector<Vector> columns;
  const auto add = [&](std::initializer_list<std::pair<Index, Index>> entries) {
    Vector column = Vector::Zero(n * p);
    for (const auto& [output, regressor] : entries) column[output * p + regressor] = 1.0;
    columns.push_back(std::move(column));
  };
  const auto add_symmetric = [&](Index first) {  // a symmetric matrix on regressors first … first + n − 1
    for (Index j = 0; j < n; ++j) {
      add({{j, first + j}});
      for (Index i = j + 1; i < n; ++i) add({{j, first + i}, {i, first + j}});
    }
  };
  if (structure == Structure::symmetric) {
    add_symmetric(0);
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) add({{j, n + i}});
    }
  } else {  // M = m I, no damping
    if (n == 1) {
      add({{0, 0}});
    } else {
      add({{0, 0}, {1, 1}});
    }
  }
  add_symmetric(2 * n);
  for (Index j = 0; j < n; ++j) add({{j, 3 * n}});
  Matrix S(n * p, static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) S.col(static_cast<Index>(k)) = columns[k];
  return S;
}

impedance::Model model_of(const Matrix& coefficients, const Vector& centre, double handle_mass) {
  const Index n = coefficients.cols();
  impedance::Model model;
  model.M = coefficients.topRows(n).transpose() - handle_mass * Matrix::Identity(n, n);
  model.B = coefficients.middleRows(n, n).transpose();
  model.K = coefficients.middleRows(2 * n, n).transpose();
  const Eigen::FullPivLU<Matrix> lu(model.K);
  model.x0 = lu.isInvertible() ? Vector(centre - lu.solve(coefficients.row(3 * n).transpose()))
                               : Vector::Constant(n, std::numeric_limits<double>::quiet_NaN());
  return model;
}

/// Covariance of [M B K (row by row) x₀] from that of φ, by the delta method:
///   dx₀ = −K⁻¹ (dc − dK (x̄ − x₀))
Matrix model_covariance(const numeric::LinearFit& fit, const Matrix& V, const impedance::Model& model,
                        const Vector& centre) {
  const Index n = model.axes(), p = 3 * n + 1;
  Matrix J = Matrix::Zero(3 * n * n + n, n * p);
  for (Index part = 0; part < 3; ++part) {
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) J(part * n * n + j * n + i, j * p + part * n + i) = 1.0;
    }
  }
  const Matrix inverse = model.K.inverse();
  const Vector offset = centre - model.x0;
  for (Index j = 0; j < n; ++j) {
    J.block(3 * n * n, j * p + 3 * n, n, 1) = -inverse.col(j);
    for (Index i = 0; i < n; ++i) J.block(3 * n * n, j * p + 2 * n + i, n, 1) = inverse.col(j) * offset[i];
  }
  const Matrix JS = J * fit.structure;
  return JS * V * JS.transpose();
}

Vector vaf(const Matrix& Y, const Matrix& residual) {
  Vector result(Y.cols());
  for (Index j = 0; j < Y.cols(); ++j) result[j] = numeric::variance_accounted_for(Y.col(j), residual.col(j));
  return result;
}

Fit judge(const Regression& r, const Matrix& coefficients) {
  const auto residual = [&](const std::vector<RowRange>& ranges) {
    return Matrix(rows_of(r.Y, ranges) - rows_of(r.Z, ranges) * coefficients);
  };
  Fit fit;
  const Matrix in_sample = residual(r.identification);
  fit.vaf_in_sample = vaf(rows_of(r.Y, r.identification), in_sample);
  fit.held_back = !r.validation.empty();
  const Matrix judged = fit.held_back ? residual(r.validation) : in_sample;
  fit.vaf = fit.held_back ? vaf(rows_of(r.Y, r.validation), judged) : fit.vaf_in_sample;
  fit.rmse.resize(r.axes());
  for (Index j = 0; j < r.axes(); ++j) fit.rmse[j] = numeric::root_mean_square(judged.col(j));
  return fit;
}

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
    result.covariance = model_covariance(*fit, V, result.model, r.centre);
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
