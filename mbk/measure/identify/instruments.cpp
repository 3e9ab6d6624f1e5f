#include "mbk/measure/identify/instruments.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/instrumental_variables.h"
#include "mbk/model/impedance/ellipse.h"

namespace mbk::identify {
namespace {

constexpr double kStrong = 10.0;  ///< first-stage F
constexpr int kPasses = 2;        ///< refinements of the nominal impedance
constexpr double kFloor = 0.02;   ///< of the nominal impedance's eigenvalues, of the largest: it must be stable
constexpr double kReach = 0.5;    ///< of an answer to the perturbation [s]
constexpr Index kLagsOfAnswer = 5;
constexpr Index kTogether = 1024;  ///< rows, side by side in the second cache

/// Every `step`-th row of the ranges, put under each other.
std::vector<RowRange> packed(const std::vector<RowRange>& ranges, Index step) {
  std::vector<RowRange> result;
  Index row = 0;
  for (const RowRange& range : ranges) {
    const Index kept = (range.size() + step - 1) / step;
    result.push_back({row, row + kept});
    row += kept;
  }
  return result;
}

/// The symmetric part with eigenvalues of at least `floor`.
Matrix lifted(const Matrix& Z, double floor) {
  const auto [values, vectors] = numeric::symmetric_eigen(impedance::symmetric_part(Z));
  return vectors * values.cwiseMax(floor).asDiagonal() * vectors.transpose();
}

double largest_eigenvalue(const Matrix& Z) {
  return std::max(numeric::symmetric_eigenvalues(impedance::symmetric_part(Z)).maxCoeff(), 0.0);
}

/// A second-order system that is stable, near the one that was found; `coefficients` are of [ẍ ẋ x].
impedance::Model stable(const Matrix& coefficients, double fastest) {
  const Index n = coefficients.cols();
  const auto part = [&](Index k) { return Matrix(coefficients.middleRows(k * n, n).transpose()); };
  impedance::Model model;
  const double stiffness = largest_eigenvalue(part(2)), damping = largest_eigenvalue(part(1));
  model.K = lifted(part(2), kFloor * stiffness);
  // Inertia that cannot be found is as small as the motion's band allows.
  const double inertia = std::max(largest_eigenvalue(part(0)), stiffness / (fastest * fastest));
  model.M = lifted(part(0), kFloor * inertia);
  model.B = lifted(part(1), std::max(kFloor * damping, 0.1 * std::sqrt(kFloor * inertia * std::max(stiffness, 1e-12))));
  model.x0 = Vector::Zero(n);
  return model;
}

/// [x̂'' x̂' x̂] of M x'' + B x' + K x = u with n axes, u straight between samples. Each range begins at rest at 0, so
/// that a step which the range begins with moves it.
template <int Axes>
Matrix simulate_axes(const impedance::Model& model, const Matrix& u, double sample_time,
                     const std::vector<RowRange>& ranges) {
  using Values = Eigen::Matrix<double, Axes, 1>;
  using Square = Eigen::Matrix<double, Axes, Axes>;
  const numeric::PivotedCholesky M(model.M);
  const Square by_position = -M.solve(model.K), by_velocity = -M.solve(model.B);
  const Square by_force = M.solve(Matrix::Identity(Axes, Axes));
  Matrix generator = Matrix::Zero(4 * Axes, 4 * Axes);
  generator.block(0, Axes, Axes, Axes).setIdentity();
  generator.block(Axes, 0, Axes, Axes) = by_position;
  generator.block(Axes, Axes, Axes, Axes) = by_velocity;
  generator.block(Axes, 2 * Axes, Axes, Axes) = by_force;
  generator.block(2 * Axes, 3 * Axes, Axes, Axes).setIdentity();
  const Matrix step = numeric::matrix_exponential(generator * sample_time);
  const Eigen::Matrix<double, 2 * Axes, 2 * Axes> state = step.topLeftCorner(2 * Axes, 2 * Axes);
  const Eigen::Matrix<double, 2 * Axes, Axes> slope = step.block(0, 3 * Axes, 2 * Axes, Axes) / sample_time,
                                              level = step.block(0, 2 * Axes, 2 * Axes, Axes) - slope;
  Matrix motion = Matrix::Zero(u.rows(), 3 * Axes);
  for (const RowRange& range : ranges) {
    Eigen::Matrix<double, 2 * Axes, 1> z = Eigen::Matrix<double, 2 * Axes, 1>::Zero();
    for (Index i = range.begin; i < range.end; ++i) {
      const Values now = u.row(i).transpose(), position = z.template head<Axes>(), velocity = z.template tail<Axes>();
      motion.row(i) << (by_position * position + by_velocity * velocity + by_force * now).transpose(),
          velocity.transpose(), position.transpose();
      if (i + 1 == range.end) break;
      z = (state * z + level * now + slope * u.row(i + 1).transpose()).eval();
    }
  }
  return motion;
}

Matrix simulate(const impedance::Model& model, const Matrix& u, double sample_time,
                const std::vector<RowRange>& ranges) {
  const auto of_axes = u.cols() == 1 ? simulate_axes<1> : (u.cols() == 2 ? simulate_axes<2> : simulate_axes<3>);
  return of_axes(model, u, sample_time, ranges);
}

/// [motion 1] with the means of the rows that count removed.
Matrix with_constant(const Matrix& motion, const std::vector<RowRange>& ranges) {
  Matrix R(motion.rows(), motion.cols() + 1);
  const Vector mean = SelectedRows(motion, ranges)->colwise().mean();
  R.leftCols(motion.cols()) = motion.rowwise() - mean.transpose();
  R.rightCols(1).setOnes();
  return R;
}

/// How strong they are, and what they are multiplied with.
void complete(const Regression& r, const InstrumentRows& rows, Instruments& made) {
  const Matrix& all = made.columns(r);
  const SelectedRows R(all, rows.ranges), Z(r.Z, rows.ranges), Y(r.Y, rows.ranges);
  made.gram = numeric::gram_of({*R, *Z, *Y});
  const Index both = R->cols() + Z->cols();
  if (rows.step == 1) {
    made.strength =
        numeric::first_stage_strength(*Z, *R, packed(rows.ranges, 1), rows.lags, made.gram.topLeftCorner(both, both));
  } else {
    const SelectedRows some_R(all, rows.ranges, rows.step), some_Z(r.Z, rows.ranges, rows.step);
    // The window of lags + 1 rows stays as long as it is.
    const auto window = static_cast<double>(rows.lags + 1) / static_cast<double>(rows.step);
    const Index lags = std::max<Index>(1, std::llround(window)) - 1;
    made.strength = numeric::first_stage_strength(*some_Z, *some_R, packed(rows.ranges, rows.step), lags);
  }
}

/// 1 + 2 Σ r[l] over the lags before the autocorrelation first falls below a tenth, of a quarter of the samples at
/// most.
double memory_of(const Eigen::Ref<const Vector>& e, double power) {
  constexpr double kForgotten = 0.1;
  constexpr Index kAtOnce = 27;
  double memory = 1.0;
  for (Index first = 1; first < e.size() / 4; first += kAtOnce) {
    const Vector sums = numeric::lagged_products(e, first, std::min(kAtOnce, e.size() / 4 - first));
    for (const double sum : sums) {
      if (sum / power < kForgotten) return memory;
      memory += 2.0 * (sum / power);
    }
  }
  return memory;
}

/// The reference as a force, and what it makes of a nominal limb on the robot.
Instruments from_force(const Regression& r, const InstrumentRows& rows) {
  const std::vector<RowRange>& ranges = rows.ranges;
  const Matrix force = r.perturbation();
  const std::vector<RowRange> whole = joined(r.identification, r.validation);
  const SelectedRows Z(r.Z, ranges), target(force, ranges);
  Instruments result;
  result.from = ReferenceQuantity::force;
  const double fastest = 0.5 / r.sample_time;  // [rad/s] about the top of the band that the rows carry
  Matrix total = numeric::PivotedQr(*Z).solve(*target);
  for (int pass = 0; pass <= kPasses; ++pass) {
    result.response = with_constant(simulate(stable(total, fastest), force, r.sample_time, whole), ranges);
    if (pass == kPasses) break;
    const SelectedRows R(result.response, ranges);
    const auto fit = numeric::fit_instrumental_variables(*Z, *R, *target);
    if (!fit || !fit->coefficients.allFinite()) break;
    total = fit->coefficients;
  }
  complete(r, rows, result);
  return result;
}

Instruments from_position(const Regression& r, const InstrumentRows& rows) {
  Instruments result{{}, ReferenceQuantity::position, {}};
  complete(r, rows, result);
  return result;
}

}  // namespace

Result<Instruments> make_instruments(const Regression& r, ReferenceQuantity quantity, const InstrumentRows& rows) {
  const Index n = r.axes();
  if (r.reference.size() == 0) {
    return bad_data("no reference was recorded, so there are no instruments",
                    "record the perturbation as channel reference (xr, yr), or use --method ls");
  }
  const SelectedRows reference(r.reference, rows.ranges);
  for (Index j = 0; j < n; ++j) {
    const auto moves = reference->col(2 * n + j);
    if (moves.maxCoeff() > moves.minCoeff()) continue;
    return bad_data("the reference is constant on one axis, so it cannot serve as an instrument",
                    "perturb in every axis, or use --method ls");
  }
  if (quantity == ReferenceQuantity::force) return from_force(r, rows);
  Instruments position = from_position(r, rows);
  if (position.strength.minCoeff() > kStrong) return position;
  // A reference of steps has no derivatives, and one without a unit may be a force: what a system makes of it remains.
  Instruments response = from_force(r, rows);
  if (quantity == ReferenceQuantity::position) response.from = ReferenceQuantity::position;
  return response.strength.minCoeff() > position.strength.minCoeff() ? std::move(response) : std::move(position);
}

Vector coherent_residual_fraction(const Regression& r, const Instruments& instruments,
                                  const std::vector<numeric::MatrixPart>& residuals,
                                  const std::vector<RowRange>& ranges, Index step) {
  const Matrix& R = instruments.columns(r);
  const Index n = r.axes(), p = R.cols(), k = n * std::ssize(residuals);
  const double between = static_cast<double>(step) * r.sample_time;  // rows [s]
  const Index every = std::max<Index>(1, std::llround(kReach / (between * static_cast<double>(kLagsOfAnswer)))) * step;
  const Index reach = every * kLagsOfAnswer, columns = p + n * kLagsOfAnswer;
  std::vector<Eigen::ArithmeticSequence<Index, Index, Index>> rows;  // of ranges, without what has no whole past
  Index count = 0;
  for (const RowRange& range : ranges) {
    if (range.size() <= reach) continue;
    rows.push_back(Eigen::seqN(range.begin + reach, (range.size() - reach + step - 1) / step, step));
    count += rows.back().size();
  }
  if (count < 2 * columns) return Vector::Constant(k, std::nan(""));
  numeric::GramSum sums(columns + k);  // of [R | the reference before | residuals]
  Matrix block(std::min(count, kTogether), columns + k);
  for (const auto& range : rows) {
    for (Index first = 0; first < range.size(); first += kTogether) {
      const Index size = std::min(kTogether, range.size() - first);
      Index column = 0;
      const auto add = [&](const numeric::MatrixPart& part, Index before) {
        const auto taken = Eigen::seqN(range[first] - before, size, step);
        block.block(0, column, size, part.cols()) = part(taken, Eigen::all);
        column += part.cols();
      };
      add(R, 0);
      for (Index lag = 1; lag <= kLagsOfAnswer; ++lag) add(r.perturbation(), lag * every);
      for (const numeric::MatrixPart& one : residuals) add(one, 0);
      sums.add(block.topRows(size));
    }
  }
  const Matrix gram = sums.gram();
  // R has a column of ones, behind the motion.
  const Vector mean = gram.row(p - 1).tail(k).transpose() / static_cast<double>(count);
  const Matrix to_Y = gram.topRightCorner(columns, k) - gram.col(p - 1).head(columns) * mean.transpose();
  Vector unit = gram.diagonal().head(columns);
  unit = (unit.array() > 0.0).select(unit.cwiseSqrt().cwiseInverse(), 1.0);
  const auto [values, vectors] =
      numeric::symmetric_eigen(unit.asDiagonal() * gram.topLeftCorner(columns, columns) * unit.asDiagonal());
  constexpr double kDependent = 1e-12;
  const Vector weights = (values.array() > kDependent * values.maxCoeff()).select(values.cwiseInverse(), 0.0);
  const Matrix along = vectors.transpose() * unit.asDiagonal() * to_Y;
  // Independent samples: those of the residual's own correlation.
  Vector share(k);
  for (Index j = 0; j < k; ++j) {
    const numeric::MatrixPart& one = residuals[static_cast<std::size_t>(j / n)];
    Vector e(count);
    Index row = 0;
    for (const auto& range : rows) {
      e.segment(row, range.size()) = one.col(j % n)(range).array() - mean[j];
      row += range.size();
    }
    const double power = e.squaredNorm(), memory = memory_of(e, power);
    const double chance = static_cast<double>(columns - 1) * memory / static_cast<double>(count);
    const double explained = power > 0.0 ? weights.dot(along.col(j).cwiseAbs2()) / power : 0.0;
    share[j] = chance < 1.0 ? std::clamp((explained - chance) / (1.0 - chance), 0.0, 1.0) : std::nan("");
  }
  return share;
}

}  // namespace mbk::identify
