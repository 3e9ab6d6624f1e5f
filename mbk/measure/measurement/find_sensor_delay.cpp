#include "mbk/measure/measurement/find_sensor_delay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/measure/preprocess/force_delay.h"
#include "mbk/measure/preprocess/prepare.h"

namespace mbk::measurement {
namespace {

constexpr int kMaxSteps = 20;
constexpr double kStays = 1e-6;        ///< [s]
constexpr double kLongestDelay = 0.2;  ///< [s]
constexpr double kSmallestVaf = 95.0;  ///< [%]
constexpr double kSameMass = 0.05;
constexpr double kWidest = 0.002;     ///< of the interval's half [s]
constexpr double kCorrelation = 1.0;  ///< of the residual's correlation [s]

/// [ẍ, its rate, 1 of each axis] and −F, the axes under each other.
struct Rows {
  Matrix Z;
  Matrix Y;
  std::vector<numeric::RowRange> ranges;
  double sample_time = 0;
};

Rows rows_of(const PreparedTrial& trial) {
  const Index n = trial.axes;
  std::vector<std::pair<Index, Index>> places;
  Rows rows;
  rows.sample_time = trial.sample_time;
  for (Index axis = 0; axis < n; ++axis) {
    for (const Segment& segment : trial.segments) {
      const auto first = static_cast<Index>(places.size());
      for (Index i = segment.begin + 1; i + 1 < segment.end; ++i) places.emplace_back(axis, i);
      rows.ranges.push_back({first, static_cast<Index>(places.size())});
    }
  }
  rows.Z = Matrix::Zero(static_cast<Index>(places.size()), 2 + n);
  rows.Y.resize(rows.Z.rows(), 1);
  for (Index k = 0; k < rows.Z.rows(); ++k) {
    const auto [axis, i] = places[static_cast<std::size_t>(k)];
    rows.Z(k, 0) = trial.acceleration(i, axis);
    rows.Z(k, 1) = (trial.acceleration(i + 1, axis) - trial.acceleration(i - 1, axis)) / (2.0 * trial.sample_time);
    rows.Z(k, 2 + axis) = 1.0;
    rows.Y(k, 0) = -trial.force_hand_on_robot(i, axis);
  }
  return rows;
}

Result<Rows> rows_with(const Recording& recording, double delay, const preprocess::Options& options) {
  auto in_time = MBK_TRY(preprocess::undo_force_delay(recording, delay));
  const auto trial = MBK_TRY(preprocess::prepare(in_time, recording::inspect(in_time), options));
  return rows_of(trial);
}

/// Of the force, by the mass alone, in the axis that it explains least of.
double vaf_of(const Rows& rows, const Matrix& coefficients, Index axes) {
  const Matrix residual = rows.Y - rows.Z * coefficients;
  const Index each = rows.Y.rows() / axes;
  double least = 100.0;
  for (Index axis = 0; axis < axes; ++axis) {
    least = std::min(least, numeric::variance_accounted_for(rows.Y.col(0).segment(axis * each, each),
                                                            residual.col(0).segment(axis * each, each)));
  }
  return least;
}

void judge(MeasuredDelay& found) {
  const double half = numeric::kNormal95 * found.delay_error;
  if (!(found.vaf >= kSmallestVaf)) {
    found.problems.push_back(fmt::format(
        "the mass explains only {:.1f} % of the force: something else is at the handle, or a channel is wrong; remove "
        "the hand and everything but the mass, and check --channels",
        found.vaf));
  }
  if (found.mass < 0.0) {
    found.problems.emplace_back("the mass is negative: the force was probably recorded with the opposite sign");
  } else if (std::abs(found.mass - found.stated_mass) >
             std::max(kSameMass * found.stated_mass, numeric::kNormal95 * found.mass_error)) {
    found.problems.push_back(
        fmt::format("the mass found is {:.4g} kg, but {:.4g} kg was stated: the gain of the sensor, a unit or the "
                    "stated mass is wrong; check --channels and --mass",
                    found.mass, found.stated_mass));
  }
  if (!(half <= kWidest)) {
    found.problems.push_back(
        fmt::format("the delay is known only to ±{:.2g} ms: move the mass faster or longer", 1e3 * half));
  }
}

}  // namespace

Result<MeasuredDelay> find_sensor_delay(const Recording& recording, double mass, const preprocess::Options& options) {
  if (!(mass > 0.0 && std::isfinite(mass))) return bad_usage(fmt::format("{:g} kg is not a mass", mass));
  preprocess::Options how = options;
  how.every = 1;
  MeasuredDelay found;
  found.stated_mass = mass;
  found.sources = recording.sources;
  bool stays = false;
  for (int step = 0; step < kMaxSteps && !stays; ++step) {
    const auto rows = MBK_TRY(rows_with(recording, found.delay, how));
    const Index axes = rows.Z.cols() - 2;
    const auto fit = MBK_TRY(numeric::fit_least_squares(rows.Z, rows.Y));
    if (fit.rank < rows.Z.cols() || fit.coefficients(0, 0) == 0.0) {
      return bad_data("the mass does not move, so its force is not known", "move it, at several frequencies");
    }
    const auto lags = static_cast<Index>(std::llround(kCorrelation / rows.sample_time));
    const Matrix V = numeric::newey_west_covariance(fit, rows.Z, rows.Y - rows.Z * fit.coefficients, rows.ranges, lags);
    found.mass = fit.coefficients(0, 0);
    found.mass_error = std::sqrt(V(0, 0));
    const double correction = -fit.coefficients(1, 0) / found.mass;
    found.delay_error = std::sqrt(V(1, 1)) / std::abs(found.mass);
    Matrix of_mass = fit.coefficients;
    of_mass(1, 0) = 0.0;
    found.vaf = vaf_of(rows, of_mass, axes);
    found.duration = static_cast<double>(rows.Y.rows()) / static_cast<double>(axes) * rows.sample_time;
    stays = std::abs(correction) < kStays;
    found.delay += correction;
    if (!(std::abs(found.delay) < kLongestDelay)) break;
  }
  judge(found);
  if (!stays) {
    found.problems.push_back(
        fmt::format("no delay up to {:g} ms makes force and acceleration consistent", 1e3 * kLongestDelay));
  }
  return found;
}

}  // namespace mbk::measurement
