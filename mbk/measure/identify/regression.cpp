#include "mbk/measure/identify/regression.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <utility>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/contents/disk_pages.h"

namespace mbk::identify {
namespace {

constexpr Index kLong = recording::kLong / 2;  ///< rows

Vector vaf(const numeric::MatrixPart& Y, const numeric::MatrixPart& residual) {
  Vector result(Y.cols());
  for (Index j = 0; j < Y.cols(); ++j) result[j] = numeric::variance_accounted_for(Y.col(j), residual.col(j));
  return result;
}

/// Where a segment of a trial stands in the regression.
struct Place {
  const PreparedTrial* trial;
  const Segment* segment;
  Index row;
};

/// An empty row keeps ranges apart between which time is broken; it belongs to none.
std::vector<Place> places_of(const std::vector<PreparedTrial>& trials) {
  std::vector<Place> places;
  Index row = 0;
  for (const PreparedTrial& trial : trials) {
    Index last_end = -1;
    for (const Segment& segment : trial.segments) {
      const bool broken = segment.begin != last_end ||
                          trial.time[segment.begin] - trial.time[segment.begin - 1] > 1.5 * trial.sample_time;
      if (row > 0 && broken) ++row;
      last_end = segment.end;
      places.push_back({&trial, &segment, row});
      row += segment.size();
    }
  }
  return places;
}

Regression stacked(const std::vector<PreparedTrial>& trials, bool with_rest) {
  const Index n = trials.front().axes;
  const std::vector<Place> places = places_of(trials);
  const Index rows = places.empty() ? 0 : places.back().row + places.back().segment->size();
  Regression r;
  r.sample_time = trials.front().sample_time;
  r.Z.resize(rows, 3 * n + 1);
  r.Y.resize(rows, n);
  const bool known = with_rest && std::ranges::all_of(trials, [](const PreparedTrial& trial) {
                       return trial.reference_motion.size() > 0;
                     });
  if (known) r.reference.resize(rows, 3 * n + 1);
  const bool computed = with_rest && std::ranges::all_of(trials, [](const PreparedTrial& trial) {
                          return trial.force_sensitivity.size() > 0;
                        });
  if (computed) {
    r.robot_covariance = trials.front().robot_covariance;
    r.force_sensitivity.resize(rows, trials.front().force_sensitivity.cols());
  }
  Index written = 0;
  for (const auto& [of, segment, row] : places) {
    const PreparedTrial& trial = *of;
    const Index begin = segment->begin, size = segment->size();
    for (Matrix* all : {&r.Z, &r.Y, &r.reference, &r.force_sensitivity}) {
      if (all->size() > 0) all->middleRows(written, row - written).setZero();
    }
    r.Z.block(row, 0, size, n) = trial.acceleration.middleRows(begin, size);
    r.Z.block(row, n, size, n) = trial.velocity.middleRows(begin, size);
    r.Z.block(row, 2 * n, size, n) = trial.position.middleRows(begin, size);
    r.Z.block(row, 3 * n, size, 1).setOnes();
    r.Y.middleRows(row, size) = -trial.force_hand_on_robot.middleRows(begin, size);
    if (known) r.reference.middleRows(row, size) << trial.reference_motion.middleRows(begin, size), Vector::Ones(size);
    if (computed) r.force_sensitivity.middleRows(row, size) = trial.force_sensitivity.middleRows(begin, size);
    (segment->purpose == Purpose::identification ? r.identification : r.validation).push_back({row, row + size});
    written = row + size;
  }
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

}  // namespace

void centre_reference(Regression& r, const std::vector<RowRange>& ranges) {
  if (r.reference.size() == 0) return;
  auto motion = r.reference.leftCols(3 * r.axes());
  const Vector mean = SelectedRows(r.reference, ranges)->leftCols(motion.cols()).colwise().mean();
  motion.rowwise() -= mean.transpose();
}

void put_on_disk(Matrix& columns) {
  if (columns.rows() >= kLong) recording::DiskPages().take(columns.data(), columns.size());
}

void put_on_disk(Regression& r) {
  if (r.Z.rows() < kLong) return;
  recording::DiskPages disk;
  for (Matrix* part : {&r.Z, &r.Y, &r.reference, &r.force_sensitivity}) disk.take(part->data(), part->size());
}

std::vector<RowRange> joined(const std::vector<RowRange>& a, const std::vector<RowRange>& b) {
  std::vector<RowRange> all = a;
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end(), [](const RowRange& x, const RowRange& y) { return x.begin < y.begin; });
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

Regression stack(const std::vector<PreparedTrial>& trials) {
  return stacked(trials, true);
}

Regression stack_motion_and_force(const std::vector<PreparedTrial>& trials) {
  return stacked(trials, false);
}

Matrix rows_of(const Matrix& all, const std::vector<RowRange>& ranges, Index step) {
  Index count = 0;
  for (const RowRange& range : ranges) count += (range.size() + step - 1) / step;
  Matrix rows(count, all.cols());
  Index row = 0;
  for (const RowRange& range : ranges) {
    const Index kept = (range.size() + step - 1) / step;
    if (step == 1) {
      rows.middleRows(row, kept) = all.middleRows(range.begin, kept);
    } else {
      rows.middleRows(row, kept) = all(Eigen::seqN(range.begin, kept, step), Eigen::all);
    }
    row += kept;
  }
  return rows;
}

Matrix structure_matrix(Structure structure, Index n) {
  const Index p = 3 * n + 1;
  if (structure == Structure::full || (structure == Structure::symmetric && n == 1)) {
    return Matrix::Identity(n * p, n * p);
  }
  std::vector<Vector> columns;
  const auto add = [&](const std::vector<std::pair<Index, Index>>& entries) {
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
    std::vector<std::pair<Index, Index>> mass;
    for (Index j = 0; j < n; ++j) mass.emplace_back(j, j);
    add(mass);
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
  const numeric::FullyPivotedLu lu(model.K);
  model.x0 = lu.invertible() ? Vector(centre - lu.solve(coefficients.row(3 * n).transpose()))
                             : Vector::Constant(n, std::numeric_limits<double>::quiet_NaN());
  return model;
}

Matrix model_covariance(const Matrix& structure, const Matrix& V, const impedance::Model& model, const Vector& centre) {
  const Index n = model.axes(), p = 3 * n + 1;
  Matrix J = Matrix::Zero(3 * n * n + n, n * p);
  for (Index part = 0; part < 3; ++part) {
    for (Index j = 0; j < n; ++j) {
      for (Index i = 0; i < n; ++i) J(part * n * n + j * n + i, j * p + part * n + i) = 1.0;
    }
  }
  const Matrix inverse = numeric::inverse(model.K);
  const Vector offset = centre - model.x0;
  for (Index j = 0; j < n; ++j) {
    J.block(3 * n * n, j * p + 3 * n, n, 1) = -inverse.col(j);
    for (Index i = 0; i < n; ++i) J.block(3 * n * n, j * p + 2 * n + i, n, 1) = inverse.col(j) * offset[i];
  }
  const Matrix JS = J * structure;
  return JS * V * JS.transpose();
}

Fit judge(const Regression& r, const Matrix& coefficients) {
  return judge_residuals(r, numeric::residuals_of({r.Z}, r.Y, coefficients));
}

Fit judge_residuals(const Regression& r, const Matrix& residuals) {
  Fit fit;
  fit.vaf_in_sample = vaf(*SelectedRows(r.Y, r.identification), *SelectedRows(residuals, r.identification));
  fit.held_out = !r.validation.empty();
  const SelectedRows judged(residuals, fit.held_out ? r.validation : r.identification);
  fit.vaf = fit.held_out ? vaf(*SelectedRows(r.Y, r.validation), *judged) : fit.vaf_in_sample;
  fit.rmse.resize(r.axes());
  for (Index j = 0; j < r.axes(); ++j) fit.rmse[j] = numeric::root_mean_square(judged->col(j));
  return fit;
}

}  // namespace mbk::identify
