#include "mbk/measure/explore/time_course.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mbk/base/core/units.h"
#include "mbk/base/dsp/decimate.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/varying_regression.h"

namespace mbk::explore {
namespace {

constexpr double kRowsPerBand = 4.0;  ///< rate over the band: half power at 1.6 times its top
constexpr Index kEnds = 6;            ///< rows at each end of a trial that the low-pass made of what it added there
constexpr Index kRowsPerCoefficient = 20;
constexpr Index kPoints = 41;
constexpr double kChanceOfChange = 1e-4;
constexpr double kChange = 0.1;  ///< of M, B or K: that which `mbk measure` warns of

/// Mean of the samples around one; NaN where one of them does not count or there are none.
double mean_around(const Vector& values, Index sample, Index width) {
  const Index begin = std::max<Index>(0, sample - width / 2), end = std::min(values.size(), sample + width / 2 + 1);
  return end > begin ? values.segment(begin, end - begin).mean() : std::numeric_limits<double>::quiet_NaN();
}

/// Rows of one variable, behind the low-pass.
struct CourseRows {
  VaryingRows rows;
  double from = 0, to = 0, sample_time = 0;
};

Result<CourseRows> course_rows(const LimbSignals& signals, const CourseVariable& variable, double band_hz) {
  const Index n = signals.axes;
  const bool instruments = signals.explained.size() > 0;
  const Index every = std::max<Index>(1, static_cast<Index>(1.0 / (signals.sample_time * kRowsPerBand * band_hz)));
  const Index ends = every > 1 ? kEnds : 0, samples = every * signals.every;
  CourseRows course;
  course.sample_time = signals.sample_time * static_cast<double>(every);
  std::vector<Matrix> parts;
  std::vector<double> s;
  Index total = 0;
  for (std::size_t k = 0; k < signals.pieces.size(); ++k) {
    const RowRange& piece = signals.pieces[k];
    const auto rows = Eigen::seqN(piece.begin, piece.size());
    Matrix all(piece.size(), (instruments ? 7 : 4) * n);
    all.leftCols(4 * n) << signals.acceleration(rows, Eigen::all), signals.velocity(rows, Eigen::all),
        signals.position(rows, Eigen::all), signals.resistance(rows, Eigen::all);
    if (instruments) {
      const Matrix explained = signals.explained(rows, Eigen::all);
      all.rightCols(3 * n) << explained.rightCols(n), explained.middleCols(n, n), explained.leftCols(n);
    }
    const auto slow = MBK_TRY(dsp::decimate(all, Hertz(1.0 / signals.sample_time), every));
    Index first = -1;
    const auto close = [&](Index end) {
      if (first < 0) return;
      parts.push_back(slow.middleRows(first, end - first));
      course.rows.ranges.push_back({total, total + end - first});
      total += end - first;
      first = -1;
    };
    for (Index j = ends; j < slow.rows() - ends; ++j) {
      const double value = mean_around(variable.values[k], signals.first_sample + j * samples, samples);
      if (!std::isfinite(value)) {
        close(j);
        continue;
      }
      if (first < 0) first = j;
      s.push_back(value);
    }
    close(slow.rows() - ends);
  }
  const Index p = 3 * n + 1;
  if (total < kRowsPerCoefficient * p) {
    return bad_data(fmt::format("{} rows at {:.3g} Hz are too few, at least {} are needed", total,
                                1.0 / course.sample_time, kRowsPerCoefficient * p),
                    "record longer");
  }
  VaryingRows& to = course.rows;
  to.Z = Matrix::Ones(total, p);
  to.R = Matrix::Ones(total, p);
  to.Y.resize(total, n);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const auto rows = Eigen::seqN(to.ranges[k].begin, to.ranges[k].size());
    to.Z(rows, Eigen::seqN(0, 3 * n)) = parts[k].leftCols(3 * n);
    to.R(rows, Eigen::seqN(0, 3 * n)) = parts[k].middleCols(instruments ? 4 * n : 0, 3 * n);
    to.Y(rows, Eigen::all) = parts[k].middleCols(3 * n, n);
  }
  to.s = Eigen::Map<const Vector>(s.data(), total);
  course.from = to.s.minCoeff();
  course.to = to.s.maxCoeff();
  if (!(course.to > course.from)) return bad_data(fmt::format("{} is constant", variable.name));
  to.s = ((to.s.array() - course.from) / (course.to - course.from)).cwiseMin(1.0).cwiseMax(0.0);
  return course;
}

/// As many functions as can follow what changes, of few coefficients beside the rows.
VaryingModel flexible(const VaryingRows& rows, Index varying) {
  constexpr Index kFunctions = 35, kRowsPerOne = 7;
  const Index functions = std::min(kFunctions, rows.Z.rows() / (kRowsPerOne * varying));
  if (functions <= 4) return {SplineBasis{0, {}}, varying};
  // A schedule may hardly take some values; a function without rows would leave nothing identifiable.
  SplineBasis basis = even_splines(functions - 3);
  const auto between = [&](double low, double high) {
    return (rows.s.array() >= low && rows.s.array() < high).count();
  };
  std::vector<double> kept;
  for (const double knot : basis.knots) {
    const bool enough = between(kept.empty() ? 0.0 : kept.back(), knot) >= kRowsPerOne * varying / 2;
    if (enough && between(knot, 2.0) >= kRowsPerOne * varying / 2) kept.push_back(knot);
  }
  basis.knots = std::move(kept);
  return {basis, varying};
}

/// Chance of so different coefficients of the functions where M, B and K do not change.
double chance_of(const VaryingFit& fit, Index functions, Index p, Index varying) {
  const Index tested = varying - 1, from = p - varying, contrasts = (functions - 1) * tested;
  double chance = 1.0;
  Matrix C = Matrix::Zero(contrasts, functions * p);
  for (Index j = 1; j < functions; ++j) {
    C.block((j - 1) * tested, j * p + from, tested, tested).setIdentity();
    C.block((j - 1) * tested, from, tested, tested) = -Matrix::Identity(tested, tested);
  }
  const Index n = fit.coefficients.cols();
  for (Index i = 0; i < n; ++i) {
    const Vector difference = C * fit.coefficients.col(i);
    Matrix V = C * fit.covariance[static_cast<std::size_t>(i)] * C.transpose();
    const Vector unit = V.diagonal().cwiseSqrt().cwiseInverse();
    V = (unit.asDiagonal() * V * unit.asDiagonal()).eval();
    const Vector scaled = unit.cwiseProduct(difference);
    const double statistic = scaled.dot(numeric::PivotedCholesky(V).solve(scaled)) / static_cast<double>(contrasts);
    chance = std::min(chance, static_cast<double>(n) *
                                  numeric::f_probability_above(statistic, static_cast<double>(contrasts), fit.freedom));
  }
  return chance;
}

/// M, B or K at some places.
/// @param values P×J, of the functions    @param part 0, 1, 2 for M, B, K
/// @param mean  of constants, n×n
MatrixCourse course_of(const VaryingFit& fit, const Matrix& values, Index n, Index part, const Matrix& mean) {
  const Index p = 3 * n + 1, J = values.cols(), P = values.rows();
  MatrixCourse course;
  course.value.resize(P, n * n);
  course.half_width.resize(P, n * n);
  course.mean = mean;
  course.mean_half_width = Matrix::Zero(n, n);
  Vector away = Vector::Zero(P), noise = Vector::Zero(P);  // squares
  for (Index i = 0; i < n; ++i) {
    for (Index l = 0; l < n; ++l) {
      const auto places = Eigen::seqN(part * n + l, J, p);
      const Vector theta = fit.coefficients(places, i);
      const Matrix V = fit.covariance[static_cast<std::size_t>(i)](places, places);
      const auto deviation = [&](const Vector& weights) { return std::sqrt(std::max(0.0, weights.dot(V * weights))); };
      const Index column = i + l * n;
      course.value.col(column) = values * theta;
      for (Index k = 0; k < P; ++k) {
        const double error = deviation(values.row(k).transpose());
        course.half_width(k, column) = numeric::kNormal95 * error;
        noise[k] += error * error;
        away[k] += (course.value(k, column) - mean(i, l)) * (course.value(k, column) - mean(i, l));
      }
    }
  }
  // Places at which little is known count little.
  const Vector weight = (noise.array() + kChange * kChange * mean.squaredNorm()).inverse();
  course.change = std::sqrt(std::max(0.0, weight.dot(away - noise)) / weight.sum()) / mean.norm();
  return course;
}

/// @param varying  of the last columns
void set_courses(const VaryingFit& constants, const VaryingFit& fit, const Matrix& values, Index varying,
                 TimeCourseEstimate& found) {
  const Index n = found.axes;
  Index part = 0;
  for (MatrixCourse* one : {&found.M, &found.B, &found.K}) {
    const Matrix mean = constants.coefficients.middleRows(part * n, n).transpose();
    const MatrixCourse constant = course_of(constants, Matrix::Ones(1, 1), n, part, mean);
    *one = course_of(fit, values, n, part, mean);
    one->mean_half_width = constant.half_width.row(0).reshaped(n, n);
    if ((3 - part) * n >= varying) one->change = 0.0;  // its columns are not among the last that vary
    ++part;
  }
}

}  // namespace

Result<TimeCourseEstimate> time_course(const LimbSignals& signals, const CourseVariable& variable, double band_hz) {
  const auto course = MBK_TRY(course_rows(signals, variable, band_hz));
  const VaryingRows& rows = course.rows;
  const Index n = signals.axes, p = 3 * n + 1;
  TimeCourseEstimate found;
  found.axes = static_cast<int>(n);
  found.variable = variable.name;
  found.unit = variable.unit;
  found.from = course.from;
  found.to = course.to;
  found.repetitions = variable.repetitions;
  found.rows = rows.Z.rows();
  found.rate_hz = 1.0 / course.sample_time;
  found.instruments = signals.explained.size() > 0;

  const VaryingModel constant{{0, {}}, p};
  // What changes would be noise to an autoregression of what constants leave, and whitening would take away just the
  // frequencies at which the limb is moved; what many functions leave is noise.
  const ChosenSplines chosen = choose_splines(rows, noise_of(rows, flexible(rows, n + 1)), {n + 1, 2 * n + 1, p});
  const VaryingModel& model = chosen.model;
  const Index functions = model.basis.size();
  const VaryingFit constants = fit_varying(rows, constant, noise_of(rows, constant));
  if (!constants.coefficients.allFinite()) return bad_data("the motion does not distinguish M, B and K");
  found.bic_gain = std::min(chosen.bic_constant, chosen.bic_last) - chosen.bic;
  const Vector places = Vector::LinSpaced(kPoints, 0.0, 1.0);
  if (functions == 1) {
    found.why = chosen.bic_refused < chosen.bic_constant
                    ? fmt::format(
                          "BIC prefers a change, but the limb was moved too little or too briefly at some values "
                          "of {} to estimate it; the values are averages",
                          variable.name)
                    : "BIC prefers a constant model";
    found.bic_gain = 0.0;
  } else if (!(found.bic_gain > 0.0)) {
    found.why = "BIC prefers a constant model with drifting force";
    found.bic_gain = 0.0;
  } else {
    const VaryingFit fit = fit_varying(rows, model, noise_of(rows, model));
    if (!fit.coefficients.allFinite()) return bad_data("the motion does not distinguish M, B and K");
    found.p_value = std::min(1.0, chance_of(fit, functions, p, model.varying));
    set_courses(constants, fit, spline_values(model.basis, places), model.varying, found);
    const double change = std::max({found.M.change, found.B.change, found.K.change});
    found.changes = found.p_value < kChanceOfChange && change > kChange;
    if (!found.changes) {
      found.why = found.p_value < kChanceOfChange ? fmt::format("they change by at most {:.0f} %, less than {:.0f} %",
                                                                100.0 * change, 100.0 * kChange)
                                                  : "the change that BIC prefers is not significant";
    }
  }
  if (found.changes) {
    found.functions = functions;
    found.degree = model.basis.degree;
    found.varying = model.varying == p ? "M, B and K" : model.varying > n + 1 ? "B and K" : "K";
    found.at = found.from + places.array() * (found.to - found.from);
    for (const double knot : model.basis.knots) found.knots.push_back(found.from + knot * (found.to - found.from));
    found.why = fmt::format("BIC prefers {} {} splines of {} to a constant model", functions,
                            model.basis.degree == 1 ? "linear" : "cubic", found.varying);
    return found;
  }
  set_courses(constants, constants, Matrix::Ones(1, 1), 1, found);
  found.at = Vector::Constant(1, 0.5 * (found.from + found.to));
  return found;
}

}  // namespace mbk::explore
