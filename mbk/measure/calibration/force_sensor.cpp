#include "mbk/measure/calibration/force_sensor.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::calibration {
namespace {

using numeric::RowRange;

/// All runs below each other; rows that a delay leaves without a load are gone.
struct Data {
  Matrix force, voltage;  ///< N×n
  std::vector<RowRange> ranges;
  Index lags = 0;
  [[nodiscard]] Index rows() const { return force.rows(); }
  [[nodiscard]] Index runs() const { return std::ssize(ranges); }
};

/// V = a_r + C F of some axes, with the covariance of [vec C; a_1; …; a_R], a and C by axes of the voltage.
struct VoltageFit {
  Matrix C;           ///< n×n [V/N]
  Matrix zeros;       ///< n×R [V]
  Matrix covariance;  ///< of θ, θ_j = [C_j1 … C_jn, a_j1 … a_jR], stacked by j
  Matrix residual;    ///< N×n [V]
  int rank = 0;
  double condition = 0.0;
};

/// Rows of `values` that come `delay` samples before those of the voltage, by straight lines between samples.
Matrix delayed(const Matrix& values, double delay, Index begin, Index count) {
  Matrix result(count, values.cols());
  for (Index i = 0; i < count; ++i) {
    const double place = static_cast<double>(begin + i) - delay;
    const auto below = std::clamp(static_cast<Index>(std::floor(place)), Index{0}, values.rows() - 1);
    const Index above = std::min(below + 1, values.rows() - 1);
    const double share = place - static_cast<double>(below);
    result.row(i) = (1.0 - share) * values.row(below) + share * values.row(above);
  }
  return result;
}

/// @param delay  τ [s]    @param trim  left out at both ends of each continuous run [s] ≥ |τ|
Data gather(const std::vector<SensorRun>& runs, double delay, double trim, double hac_lag_s) {
  Data data;
  Index rows = 0;
  const auto n = runs.front().force.cols();
  std::vector<Index> cut;
  for (const SensorRun& run : runs) {
    cut.push_back(run.interval && trim > 0.0 ? static_cast<Index>(std::ceil(trim / *run.interval)) : 0);
    const Index count = run.force.rows() - 2 * cut.back();
    data.ranges.push_back({rows, rows + count});
    rows += count;
  }
  data.force.resize(rows, n);
  data.voltage.resize(rows, n);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const auto [begin, end] = data.ranges[r];
    const double samples = runs[r].interval ? delay / *runs[r].interval : 0.0;
    data.force.middleRows(begin, end - begin) = delayed(runs[r].force, samples, cut[r], end - begin);
    data.voltage.middleRows(begin, end - begin) = runs[r].voltage.middleRows(cut[r], end - begin);
    if (runs[r].interval) {
      data.lags = std::max(data.lags, static_cast<Index>(std::llround(hac_lag_s / *runs[r].interval)));
    }
  }
  data.lags = std::min(data.lags, rows / 4);
  return data;
}

Matrix regressors(const Data& data, const Matrix& force) {
  Matrix Z(data.rows(), force.cols() + data.runs());
  Z.leftCols(force.cols()) = force;
  Z.rightCols(data.runs()).setZero();
  for (Index r = 0; r < data.runs(); ++r) {
    const RowRange& range = data.ranges[static_cast<std::size_t>(r)];
    Z.col(force.cols() + r).segment(range.begin, range.size()).setOnes();
  }
  return Z;
}

/// Of θ stacked by outputs: Σ ⊗ (ZᵀZ)⁻¹ where each row is by itself, and what holds for correlated residuals otherwise.
Matrix covariance_of(const numeric::LinearFit& fit, const Matrix& Z, const Matrix& residual, const Data& data,
                     bool continuous) {
  if (continuous) return numeric::newey_west_covariance(fit, Z, residual, data.ranges, data.lags);
  const Matrix sigma = residual.transpose() * residual / static_cast<double>(Z.rows() - Z.cols());
  const Index p = Z.cols();
  Matrix covariance(p * sigma.rows(), p * sigma.rows());
  for (Index j = 0; j < sigma.rows(); ++j) {
    for (Index k = 0; k < sigma.cols(); ++k) {
      covariance.block(j * p, k * p, p, p) = sigma(j, k) * fit.inverse_gram.topLeftCorner(p, p);
    }
  }
  return covariance;
}

Result<VoltageFit> fit_voltage(const Data& data, const std::vector<Index>& axes, bool continuous) {
  const Matrix force = data.force(Eigen::all, axes), voltage = data.voltage(Eigen::all, axes);
  const Matrix Z = regressors(data, force);
  const auto fit = MBK_TRY(numeric::fit_least_squares(Z, voltage));
  VoltageFit result;
  const Index n = force.cols();
  result.rank = fit.rank;
  result.condition = fit.condition;
  if (fit.rank < Z.cols()) return result;
  result.C = fit.coefficients.topRows(n).transpose();
  result.zeros = fit.coefficients.bottomRows(data.runs()).transpose();
  result.residual = voltage - Z * fit.coefficients;
  result.covariance = covariance_of(fit, Z, result.residual, data, continuous);
  return result;
}

double residual_variance(const Data& data) {
  const Matrix Z = regressors(data, data.force);
  const auto fit = numeric::fit_least_squares(Z, data.voltage);
  if (!fit) return std::numeric_limits<double>::infinity();
  const Matrix residual = data.voltage - Z * fit->coefficients;
  // Each axis in units of its own spread, since one axis may be louder than the other.
  double sum = 0.0;
  for (Index j = 0; j < residual.cols(); ++j) {
    sum += residual.col(j).squaredNorm() / std::max(numeric::variance(data.voltage.col(j)), 1e-300);
  }
  return sum;
}

/// τ that leaves the least, on whole samples and then by a parabola; 0 where it does not lower the residual by 1 %.
double find_delay(const std::vector<SensorRun>& runs, const SensorCalibrationOptions& options) {
  constexpr double kWorthIt = 0.99;
  const double interval = *runs.front().interval;
  Index most = static_cast<Index>(std::floor(options.longest_delay / interval));
  for (const SensorRun& run : runs) most = std::min(most, run.force.rows() / 10);
  if (most < 1) return 0.0;
  const double trim = static_cast<double>(most + 1) * interval;
  const auto variance_at = [&](Index lag) {
    return residual_variance(gather(runs, static_cast<double>(lag) * interval, trim, 0.0));
  };
  std::vector<double> variances;
  for (Index lag = -most; lag <= most; ++lag) variances.push_back(variance_at(lag));
  const auto least = std::ranges::min_element(variances);
  const Index place = least - variances.begin();
  if (!(*least < kWorthIt * variances[static_cast<std::size_t>(most)])) return 0.0;
  double fraction = 0.0;
  if (place > 0 && place < 2 * most) {
    const double before = *(least - 1), after = *(least + 1), bend = before - 2.0 * *least + after;
    if (bend > 0.0) fraction = 0.5 * (before - after) / bend;
  }
  return (static_cast<double>(place - most) + fraction) * interval;
}

/// Rows of one load, in the order in which they came.
struct Group {
  double load = 0.0;  ///< on the axis in question [N]
  std::vector<Index> rows;
};

/// Rows of exactly equal loads on every axis of one run. Where they are few (a reference that scatters), none.
std::vector<Group> equal_loads(const Data& data, Index axis) {
  std::map<std::vector<double>, Group> groups;
  for (std::size_t r = 0; r < data.ranges.size(); ++r) {
    for (Index i = data.ranges[r].begin; i < data.ranges[r].end; ++i) {
      std::vector<double> key{static_cast<double>(r)};
      for (Index j = 0; j < data.force.cols(); ++j) key.push_back(data.force(i, j));
      Group& group = groups[key];
      group.load = data.force(i, axis);
      group.rows.push_back(i);
    }
  }
  std::vector<Group> result;
  for (auto& [key, group] : groups) result.push_back(std::move(group));
  return result;
}

/// Rows put into equal intervals of the load on one axis.
std::vector<Group> load_intervals(const Data& data, Index axis) {
  constexpr Index kIntervals = 20;
  const Vector load = data.force.col(axis);
  const double low = load.minCoeff(), width = (load.maxCoeff() - low) / kIntervals;
  std::vector<Group> groups(kIntervals);
  for (Index i = 0; i < load.size(); ++i) {
    const auto k = std::min(static_cast<Index>((load[i] - low) / width), kIntervals - 1);
    groups[static_cast<std::size_t>(k)].rows.push_back(i);
  }
  std::erase_if(groups, [](const Group& group) { return group.rows.empty(); });
  for (Group& group : groups) group.load = load(group.rows).mean();
  return groups;
}

/// Of each row: 1 where the load on the axis last rose, −1 where it last fell, 0 before it changed.
std::vector<int> directions(const Data& data, Index axis) {
  std::vector<int> direction(static_cast<std::size_t>(data.rows()), 0);
  for (const RowRange& range : data.ranges) {
    int now = 0;
    for (Index i = range.begin + 1; i < range.end; ++i) {
      const double change = data.force(i, axis) - data.force(i - 1, axis);
      if (change != 0.0) now = change > 0.0 ? 1 : -1;
      direction[static_cast<std::size_t>(i)] = now;
    }
  }
  return direction;
}

/// The rows of a group that came in one direction.
std::vector<Index> rows_of(const Group& group, const std::vector<int>& direction, int requested) {
  std::vector<Index> rows;
  for (const Index i : group.rows) {
    if (direction[static_cast<std::size_t>(i)] == requested) rows.push_back(i);
  }
  return rows;
}

/// Standard deviation at one load that was reached one way, pooled; absent with fewer than 4 degrees of freedom.
std::optional<double> noise_at_constant_load(const Vector& voltage, const std::vector<Group>& groups,
                                             const std::vector<int>& direction) {
  constexpr Index kMin = 4;
  double sum = 0.0;
  Index freedom = 0;
  for (const Group& group : groups) {
    for (const int way : {-1, 0, 1}) {
      const std::vector<Index> rows = rows_of(group, direction, way);
      if (rows.size() < 2) continue;
      const Vector values = voltage(rows);
      sum += (values.array() - values.mean()).square().sum();
      freedom += values.size() - 1;
    }
  }
  if (freedom < kMin) return std::nullopt;
  return std::sqrt(sum / static_cast<double>(freedom));
}

/// A deviation and its standard error.
struct Deviation {
  double value = 0.0, error = 0.0;
};

Deviation mean_of(const Vector& residual, const std::vector<Index>& rows, double scatter) {
  return {residual(rows).mean(), scatter / std::sqrt(static_cast<double>(rows.size()))};
}

/// Differences between the means at one load that was reached upwards and downwards.
struct Hysteresis {
  double largest = 0.0;  ///< magnitude [N]
  Deviation mean;        ///< over the loads; its error from how they differ among themselves
};

/// Absent with fewer than 3 loads that were reached both ways.
std::optional<Hysteresis> hysteresis_of(const std::vector<Group>& groups, const std::vector<int>& direction,
                                        const Vector& residual) {
  constexpr std::size_t kMin = 3;
  std::vector<double> differences;
  for (const Group& group : groups) {
    const std::vector<Index> up = rows_of(group, direction, 1), down = rows_of(group, direction, -1);
    if (!up.empty() && !down.empty()) differences.push_back(residual(up).mean() - residual(down).mean());
  }
  if (differences.size() < kMin) return std::nullopt;
  const Vector all = Eigen::Map<const Vector>(differences.data(), std::ssize(differences));
  return Hysteresis{all.cwiseAbs().maxCoeff(),
                    {all.mean(), std::sqrt(numeric::variance(all) / static_cast<double>(all.size()))}};
}

ForceOnVoltage force_on_voltage(const Data& data, Index axis, bool continuous) {
  Matrix Z(data.rows(), 2);
  Z << data.voltage.col(axis), Vector::Ones(data.rows());
  const Matrix F = data.force.col(axis);
  ForceOnVoltage line;
  const auto fit = numeric::fit_least_squares(Z, F);
  if (!fit) return line;
  const Matrix residual = F - Z * fit->coefficients;
  const Matrix covariance = covariance_of(*fit, Z, residual, data, continuous);
  line.slope = fit->coefficients(0, 0);
  line.intercept = fit->coefficients(1, 0);
  line.slope_error = std::sqrt(covariance(0, 0));
  line.intercept_error = std::sqrt(covariance(1, 1));
  line.r_squared = 1.0 - residual.squaredNorm() / (F.array() - F.mean()).square().sum();
  return line;
}

class Calibrator {
 public:
  Calibrator(const std::vector<SensorRun>& runs, const SensorCalibrationOptions& options)
      : runs_(runs), options_(options) {}

  Result<SensorCalibration> run() {
    MBK_TRY(check());
    result_.continuous = runs_.front().interval.has_value();
    if (result_.continuous && options_.longest_delay > 0.0) result_.delay = find_delay(runs_, options_);
    data_ = gather(runs_, result_.delay, std::abs(result_.delay), options_.hac_lag_s);
    if (result_.continuous) result_.hac_lag_s = static_cast<double>(data_.lags) * *runs_.front().interval;
    result_.rows = data_.rows();
    result_.lever_arm = options_.lever_arm;
    for (const SensorRun& run : runs_) {
      result_.sources.push_back(run.source);
      for (const std::string& note : run.notes) {
        if (std::ranges::find(result_.notes, note) == result_.notes.end()) result_.notes.push_back(note);
      }
    }
    MBK_TRY(fit());
    for (Index i = 0; i < n(); ++i) judge(i);
    compare_zeros();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Index n() const { return std::ssize(runs_.front().axes); }
  [[nodiscard]] const std::string& name(Index axis) const { return runs_.front().axes[static_cast<std::size_t>(axis)]; }

  void warn(SensorWarningCode code, std::string message, std::string remedy) {
    result_.warnings.push_back({code, std::move(message), std::move(remedy)});
  }

  Result<void> check() const {
    if (runs_.empty()) return bad_usage("no runs");
    if (options_.lever_arm && !(*options_.lever_arm > 0.0 && std::isfinite(*options_.lever_arm))) {
      return bad_usage(fmt::format("the lever arm of {:g} m is not above 0", *options_.lever_arm));
    }
    if (const auto& c = options_.converter;
        c && (c->bits < 2 || c->bits > 32 || !(c->range > 0.0 && std::isfinite(c->range)))) {
      return bad_usage(fmt::format("a converter of {} bits and ±{:g} V is not one of 2 to 32 bits and a range above 0",
                                   c->bits, c->range));
    }
    if (!(options_.hac_lag_s >= 0.0 && std::isfinite(options_.hac_lag_s)) ||
        !(options_.longest_delay >= 0.0 && std::isfinite(options_.longest_delay))) {
      return bad_usage("the noise correlation time or the longest delay is not 0 or more");
    }
    Index rows = 0;
    for (const SensorRun& run : runs_) {
      if (run.axes != runs_.front().axes) {
        return bad_data("its axes differ from those of the first file", "calibrate each sensor separately",
                        run.source.label());
      }
      if (run.interval.has_value() != runs_.front().interval.has_value()) {
        return bad_data("tables of loads and recordings over time cannot be combined", "calibrate them separately",
                        run.source.label());
      }
      rows += run.force.rows();
    }
    const Index parameters = n() + std::ssize(runs_);
    if (rows < parameters + 1) {
      return bad_data(fmt::format("{} rows are too few for {} parameters and their errors", rows, parameters),
                      "apply more loads, of both signs on each axis, each more than once",
                      runs_.front().source.label());
    }
    for (Index i = 0; i < n(); ++i) {
      double spread = 0.0;
      for (const SensorRun& run : runs_) {
        spread = std::max(spread, run.force.col(i).maxCoeff() - run.force.col(i).minCoeff());
      }
      if (spread > 0.0) continue;
      return fail(ErrorKind::not_usable, fmt::format("the load on {} never changes within a run", name(i)),
                  fmt::format("load that axis too, or remove voltage_{} from --channels", name(i)),
                  runs_.front().source.label());
    }
    return {};
  }

  /// C and a of all axes together, or of each by itself.
  Result<void> fit() {
    const Index axes = n(), runs = data_.runs(), p = axes + runs;
    std::vector<Index> all(static_cast<std::size_t>(axes));
    std::iota(all.begin(), all.end(), Index{0});
    C_ = Matrix::Zero(axes, axes);
    zeros_.resize(axes, runs);
    residual_.resize(data_.rows(), axes);
    covariance_ = Matrix::Zero(axes * p, axes * p);
    if (options_.crosstalk && axes > 1) {
      const auto whole = MBK_TRY(fit_voltage(data_, all, result_.continuous));
      constexpr double kNearlyOneLine = 30.0;
      if (whole.rank < p || !(whole.condition < 1e6)) {
        return fail(
            ErrorKind::not_usable, "the loads lie on one line, so crosstalk cannot be distinguished from the slopes",
            "load each axis separately, or fit each axis separately with --axes 1", runs_.front().source.label());
      }
      if (whole.condition > kNearlyOneLine) {
        warn(SensorWarningCode::loads_nearly_collinear,
             fmt::format("the loads are nearly on one line (condition number {:.0f})", whole.condition),
             "also load each axis separately");
      }
      C_ = whole.C;
      zeros_ = whole.zeros;
      residual_ = whole.residual;
      covariance_ = whole.covariance;
    } else {
      for (Index i = 0; i < axes; ++i) {
        const auto one = MBK_TRY(fit_voltage(data_, {i}, result_.continuous));
        C_(i, i) = one.C(0, 0);
        zeros_.row(i) = one.zeros;
        residual_.col(i) = one.residual;
        const Index at = i * p;
        // [C_ii, a_i1 … a_iR] among [C_i1 … C_in, a_i1 … a_iR]
        std::vector<Index> places{at + i};
        for (Index r = 0; r < runs; ++r) places.push_back(at + axes + r);
        for (Index a = 0; a < std::ssize(places); ++a) {
          for (Index b = 0; b < std::ssize(places); ++b) {
            covariance_(places[static_cast<std::size_t>(a)], places[static_cast<std::size_t>(b)]) =
                one.covariance(a, b);
          }
        }
      }
    }
    MBK_TRY(follows());
    invert();
    return {};
  }

  /// A voltage that does not follow its load gives a slope of 1/0.
  Result<void> follows() const {
    constexpr double kSeen = 5.0;
    const Index p = n() + data_.runs();
    for (Index i = 0; i < n(); ++i) {
      const double error = std::sqrt(covariance_(i * p + i, i * p + i));
      if (C_(i, i) != 0.0 && std::abs(C_(i, i)) > kSeen * error) continue;
      return fail(ErrorKind::not_usable,
                  fmt::format("voltage_{0} does not follow force_{0}: {1:.3g} ± {2:.2g} V/N", name(i), C_(i, i),
                              numeric::kNormal95 * error),
                  "check which column is which with --channels", runs_.front().source.label());
    }
    return {};
  }

  /// S = C⁻¹, dS = −S dC S;  b = −S a, db = −dS a − S da;  X_ji = C_ji/C_jj.
  void invert() {
    const Index axes = n(), p = axes + data_.runs(), last = p - 1;
    const Matrix S = numeric::inverse(C_);
    const Vector zero = zeros_.col(data_.runs() - 1);
    const auto error_of = [&](const Vector& gradient) {
      return std::sqrt(std::max(0.0, gradient.dot(covariance_ * gradient)));
    };
    result_.slope = S;
    result_.slope_error = Matrix::Zero(axes, axes);
    const bool whole = options_.crosstalk && axes > 1;
    for (Index a = 0; a < axes; ++a) {
      for (Index b = 0; b < axes; ++b) {
        if (!whole && a != b) continue;
        Vector gradient = Vector::Zero(axes * p);
        for (Index j = 0; j < axes; ++j) {
          for (Index i = 0; i < axes; ++i) gradient[j * p + i] = -S(a, j) * S(i, b);
        }
        result_.slope_error(a, b) = error_of(gradient);
      }
    }
    for (Index a = 0; a < axes; ++a) {
      SensorAxis axis;
      axis.name = name(a);
      axis.zero_voltage = zero[a];
      axis.intercept = -S.row(a).dot(zero);
      Vector of_zero = Vector::Zero(axes * p), of_intercept = of_zero;
      of_zero[a * p + last] = 1.0;
      for (Index j = 0; j < axes; ++j) {
        for (Index i = 0; i < axes; ++i) of_intercept[j * p + i] = S(a, j) * S.row(i).dot(zero);
        of_intercept[j * p + last] = -S(a, j);
      }
      axis.zero_voltage_error = error_of(of_zero);
      axis.intercept_error = error_of(of_intercept);
      result_.axes.push_back(std::move(axis));
    }
    for (Index r = 0; r < data_.runs(); ++r) result_.zero_voltages.emplace_back(zeros_.col(r));
    if (!whole) return;
    result_.crosstalk = result_.crosstalk_error = Matrix::Zero(axes, axes);
    for (Index j = 0; j < axes; ++j) {
      for (Index i = 0; i < axes; ++i) {
        if (i == j) continue;
        Vector gradient = Vector::Zero(axes * p);
        gradient[j * p + i] = 1.0 / C_(j, j);
        gradient[j * p + j] = -C_(j, i) / (C_(j, j) * C_(j, j));
        result_.crosstalk(j, i) = C_(j, i) / C_(j, j);
        result_.crosstalk_error(j, i) = error_of(gradient);
      }
    }
  }

  /// What the data say of one axis beside its slope.
  void judge(Index i) {
    SensorAxis& axis = result_.axes[static_cast<std::size_t>(i)];
    const Vector load = data_.force.col(i), voltage = data_.voltage.col(i);
    axis.published = force_on_voltage(data_, i, result_.continuous);
    double about_means = 0.0;
    for (const RowRange& range : data_.ranges) {
      const auto part = voltage.segment(range.begin, range.size());
      about_means += (part.array() - part.mean()).square().sum();
    }
    axis.r_squared = 1.0 - residual_.col(i).squaredNorm() / about_means;
    const Vector deviation = residual_ * result_.slope.row(i).transpose();  // S (V − V₀) − F, with each run's zero
    axis.rmse = numeric::root_mean_square(deviation);
    axis.full_scale = load.cwiseAbs().maxCoeff();

    std::vector<Group> groups = equal_loads(data_, i);
    const bool repeats = std::ssize(groups) <= data_.rows() / 2;
    const bool by_load = repeats || !result_.continuous;
    const std::vector<int> direction = directions(data_, i);
    if (by_load) axis.noise = noise_at_constant_load(voltage, groups, direction);
    const double scatter = axis.noise ? std::abs(result_.slope(i, i)) * *axis.noise : axis.rmse;
    if (by_load) {
      if (const auto found = hysteresis_of(groups, direction, deviation)) {
        axis.hysteresis = found->largest;
        judge_hysteresis(axis, found->mean);
      }
    } else {
      groups = load_intervals(data_, i);
    }
    Deviation largest;
    for (const Group& group : groups) {
      const Deviation mean = mean_of(deviation, group.rows, scatter);
      if (std::abs(mean.value) > std::abs(largest.value)) largest = mean;
    }
    axis.nonlinearity = std::abs(largest.value);
    judge_loads(axis, load, by_load, groups);
    judge_linearity(axis, largest);
    judge_converter(axis, i);
  }

  void judge_loads(SensorAxis& axis, const Vector& load, bool by_load, const std::vector<Group>& groups) {
    constexpr Index kMin = 5;
    constexpr double kOtherSide = 0.1;
    std::vector<double> loads;
    for (const Group& group : groups) loads.push_back(group.load);
    std::ranges::sort(loads);
    axis.loads = std::unique(loads.begin(), loads.end()) - loads.begin();
    if (by_load && axis.loads < kMin) {
      warn(SensorWarningCode::few_loads, fmt::format("{} has {} different loads", axis.name, axis.loads),
           "apply at least five, in both directions");
    }
    const double low = load.minCoeff(), high = load.maxCoeff();
    if (!(low < -kOtherSide * axis.full_scale) || !(high > kOtherSide * axis.full_scale)) {
      warn(SensorWarningCode::one_sided_loads,
           fmt::format("the loads on {} are from {:.3g} to {:.3g} N: the opposite direction is not calibrated",
                       axis.name, low, high),
           "also load it in the opposite direction");
    }
  }

  void judge_linearity(const SensorAxis& axis, const Deviation& largest) {
    constexpr double kShare = 0.01, kSeen = 3.0;
    if (axis.nonlinearity > kShare * axis.full_scale && axis.nonlinearity > kSeen * largest.error) {
      warn(SensorWarningCode::nonlinear,
           fmt::format("{} deviates from its line by {:.3g} N, {:.1f} % of the largest load", axis.name,
                       axis.nonlinearity, 100.0 * axis.nonlinearity / axis.full_scale),
           "look for a misread load, a beam that touches something, or crosstalk that was not fitted; or calibrate "
           "over the range that you need");
    }
  }

  /// @param mean  of the differences over the loads: noise alone has none, a loop has one sign throughout
  void judge_hysteresis(const SensorAxis& axis, const Deviation& mean) {
    constexpr double kShare = 0.01, kSeen = 3.0;
    if (*axis.hysteresis > kShare * axis.full_scale && std::abs(mean.value) > kSeen * mean.error) {
      warn(SensorWarningCode::hysteresis,
           fmt::format("loading and unloading of {} differ by {:.3g} N, {:.1f} % of the largest load", axis.name,
                       *axis.hysteresis, 100.0 * *axis.hysteresis / axis.full_scale),
           "tighten the mounting of the sensor, and wait until the load hangs still");
    }
  }

  void judge_converter(SensorAxis& axis, Index i) {
    constexpr double kSameStep = 0.02, kUnlikely = 100.0, kSpread = 0.05;
    const Vector voltage = data_.voltage.col(i), load = data_.force.col(i);
    axis.step = quantisation_step(voltage);
    if (options_.converter) axis.conversion = options_.converter->step();
    if (axis.step && axis.conversion && std::abs(*axis.step / *axis.conversion - 1.0) > kSameStep) {
      warn(SensorWarningCode::step_contradicts_converter,
           fmt::format("the voltages of {} have steps of {:.4g} mV, but {} bits over ±{:g} V give {:.4g} mV", axis.name,
                       1e3 * *axis.step, options_.converter->bits, options_.converter->range, 1e3 * *axis.conversion),
           "correct --bits and --range, or omit them");
    }
    const double largest = voltage.cwiseAbs().maxCoeff();
    if (largest > kUnlikely) {
      warn(SensorWarningCode::voltage_unlikely, fmt::format("voltage_{} reaches {:.4g} V", axis.name, largest),
           fmt::format("if the file is in millivolts, use --channels V{}=NAME:mV", axis.name));
    }
    for (const double end : {voltage.minCoeff(), voltage.maxCoeff()}) {
      std::vector<Index> rows;
      for (Index k = 0; k < voltage.size(); ++k) {
        if (voltage[k] == end) rows.push_back(k);
      }
      const Vector there = load(rows);
      const bool flat = there.maxCoeff() - there.minCoeff() > kSpread * axis.full_scale;
      const bool at_limit = options_.converter && std::abs(end) >= options_.converter->range - 1.5 * *axis.conversion;
      if (!flat && !at_limit) continue;
      warn(SensorWarningCode::clipping,
           fmt::format("voltage_{} stays at {:.5g} V in {} rows{}", axis.name, end, rows.size(),
                       flat ? fmt::format(", with loads from {:.3g} to {:.3g} N", there.minCoeff(), there.maxCoeff())
                            : ", the end of the converter's range"),
           "omit these rows, and lower the gain of the amplifier");
    }
    if (axis.noise && axis.resolution() && *axis.noise < *axis.resolution() / std::sqrt(12.0)) {
      warn(SensorWarningCode::noise_below_resolution,
           fmt::format("the noise of {} at constant load, {:.2g} mV, is below the {:.2g} mV of rounding noise at a "
                       "changing load: the converter step hides it",
                       axis.name, 1e3 * *axis.noise, 1e3 * *axis.resolution() / std::sqrt(12.0)),
           "use the rounding noise as the resolution");
    }
  }

  void compare_zeros() {
    constexpr double kSeen = 3.0;
    if (data_.runs() < 2) return;
    const Index p = n() + data_.runs();
    for (Index i = 0; i < n(); ++i) {
      Index low = 0, high = 0;
      const double spread = zeros_.row(i).maxCoeff(&high) - zeros_.row(i).minCoeff(&low);
      Vector gradient = Vector::Zero(covariance_.rows());
      gradient[i * p + n() + high] = 1.0;
      gradient[i * p + n() + low] = -1.0;
      const double error = std::sqrt(std::max(0.0, gradient.dot(covariance_ * gradient)));
      if (!(spread > kSeen * error) || low == high) continue;
      warn(SensorWarningCode::zero_changed,
           fmt::format("the zero of {} differs by {:.3g} V ({:.3g} N) between runs", name(i), spread,
                       spread * std::abs(result_.slope(i, i))),
           "measure the zero in each recording with --sensor-zero auto:2");
    }
  }

  const std::vector<SensorRun>& runs_;
  const SensorCalibrationOptions& options_;
  SensorCalibration result_;
  Data data_;
  Matrix C_, zeros_, residual_, covariance_;
};

/// @returns the columns, N×(names)
Result<Matrix> columns(const Recording& recording, const std::vector<std::string>& names) {
  Matrix values(recording.samples(), std::ssize(names));
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Channel* const channel = recording.find(names[k]);
    for (Index i = 0; i < channel->values.size(); ++i) {
      if (std::isfinite(channel->values[i])) continue;
      return bad_data(fmt::format("{} is not a number at row {}", names[k], i + 1), "omit that row");
    }
    values.col(static_cast<Index>(k)) = channel->values;
  }
  return values;
}

/// Base frame → axes of the sensor, row by row.
Result<void> turn_into_link(const Recording& recording, SensorRun& run) {
  const Channel* const joint = recording.find("joint_2");
  if (joint == nullptr || joint->unit != "rad") {
    return bad_data("joint_2 is not recorded, so the sensor's axes are not known",
                    "name it, as in --channels q2=NAME, or pass --sensor-frame base");
  }
  if (run.axes.size() < 2) {
    return bad_data("the sensor turns with the last link, but a force with one axis cannot be rotated",
                    "name both axes, or pass --sensor-frame base");
  }
  const auto theta = MBK_TRY(columns(recording, {"joint_2"}));
  for (Index i = 0; i < run.force.rows(); ++i) {
    run.force.row(i) = run.force.row(i) * robot::link_axes(theta(i, 0));  // (Rᵀ f)ᵀ = fᵀ R
  }
  run.notes.emplace_back("the force was rotated into the axes of the last link with joint_2 (eq. E.4)");
  return {};
}

}  // namespace

Result<SensorRun> sensor_run(const Recording& recording, SensorFrame frame) {
  SensorRun run;
  if (!recording.sources.empty()) run.source = recording.sources.front();
  const auto has = [&](const char* kind, const std::string& axis) {
    return recording.find(fmt::format("{}_{}", kind, axis)) != nullptr;
  };
  std::vector<std::string> forces, voltages, unloaded;
  for (const std::string axis : {"x", "y"}) {
    if (!has("voltage", axis)) continue;
    if (!has("force", axis)) {
      unloaded.push_back(axis);
      continue;
    }
    run.axes.push_back(axis);
    forces.push_back("force_" + axis);
    voltages.push_back("voltage_" + axis);
  }
  if (run.axes.empty()) {
    const bool any_voltage = has("voltage", "x") || has("voltage", "y");
    return bad_data(
        any_voltage ? "the recording has a voltage but no force" : "the recording has neither voltage_x nor voltage_y",
        "name loads and voltages, as in --channels Fx=1,Fy=2,Vx=3,Vy=4; a hung mass in kg is Fx=mass*9.81",
        run.source.label());
  }
  const auto force = columns(recording, forces);
  if (!force) return tl::unexpected(force.error().in(run.source.label()));
  run.force = *force;
  for (const std::string& axis : unloaded) {
    run.axes.push_back(axis);
    voltages.push_back("voltage_" + axis);
    run.force.conservativeResize(Eigen::NoChange, run.force.cols() + 1);
    run.force.col(run.force.cols() - 1).setZero();
    run.notes.push_back(fmt::format("{}: force_{} is missing and assumed to be 0 N", run.source.label(), axis));
  }
  const auto voltage = columns(recording, voltages);
  if (!voltage) return tl::unexpected(voltage.error().in(run.source.label()));
  run.voltage = *voltage;
  if (run.axes.size() == 2 && run.axes.front() == "y") {  // x first
    std::ranges::reverse(run.axes);
    run.force = run.force.rowwise().reverse().eval();
    run.voltage = run.voltage.rowwise().reverse().eval();
  }
  const bool joint = recording.find("joint_2") != nullptr;
  if (frame == SensorFrame::link || (frame == SensorFrame::automatic && joint)) {
    if (auto ok = turn_into_link(recording, run); !ok) return tl::unexpected(ok.error().in(run.source.label()));
  }
  if (recording.untimed) return run;
  for (Index i = 1; i < recording.samples(); ++i) {
    if (recording.time[i] > recording.time[i - 1]) continue;
    return bad_data(fmt::format("time does not increase at sample {}", i + 1), "correct the time, or give --rate",
                    run.source.label());
  }
  if (recording.samples() > 1) {
    run.interval =
        (recording.time[recording.samples() - 1] - recording.time[0]) / static_cast<double>(recording.samples() - 1);
  }
  return run;
}

Result<SensorCalibration> calibrate_sensor(const std::vector<SensorRun>& runs,
                                           const SensorCalibrationOptions& options) {
  return Calibrator(runs, options).run();
}

std::optional<double> quantisation_step(const Vector& values) {
  constexpr std::size_t kMin = 8;
  constexpr double kOff = 0.05;
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  const double spread = sorted.empty() ? 0.0 : sorted.back() - sorted.front();
  std::vector<double> gaps;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double gap = sorted[i] - sorted[i - 1];
    if (gap > 1e-9 * spread) gaps.push_back(gap);
  }
  if (gaps.size() + 1 < kMin) return std::nullopt;
  // From the smallest gap up, so that the step is known the better the more of it a gap holds.
  std::ranges::sort(gaps);
  double steps = 0.0, sum = 0.0;
  for (const double gap : gaps) {
    const double step = steps > 0.0 ? sum / steps : gap;
    const double multiple = std::round(gap / step);
    if (std::abs(gap / step - multiple) > kOff) return std::nullopt;
    steps += multiple;
    sum += gap;
  }
  return sum / steps;
}

}  // namespace mbk::calibration
