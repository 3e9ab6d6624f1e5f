#include "mbk/measure/analyse/compare_forces.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/option_limits.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::analyse {
namespace {

enum class Part { reversal, rest, motion };

Result<void> check(const std::vector<ForcePair>& segments) {
  Index rows = 0;
  for (const ForcePair& pair : segments) {
    const ForcePair& first = segments.front();
    if (pair.estimated.rows() != pair.measured.rows() || pair.estimated.rows() != pair.joint_velocity.rows() ||
        pair.estimated.cols() != pair.measured.cols() || pair.estimated.cols() != first.estimated.cols() ||
        pair.joint_velocity.cols() != first.joint_velocity.cols()) {
      return bad_data(fmt::format("forces of {}×{} and {}×{} values and velocities of {}×{} cannot be compared",
                                  pair.estimated.rows(), pair.estimated.cols(), pair.measured.rows(),
                                  pair.measured.cols(), pair.joint_velocity.rows(), pair.joint_velocity.cols()),
                      "give both forces and the velocity on the same rows");
    }
    const auto finite = [&](const char* what, const Matrix& values) -> Result<void> {
      for (Index axis = 0; axis < values.cols(); ++axis) {
        if (const Index bad = first_non_finite(values.col(axis)); bad >= 0) {
          return bad_data(fmt::format("{} {} is not a finite number at row {}", what, axis + 1, rows + bad),
                          "omit the row");
        }
      }
      return {};
    };
    MBK_TRY(finite("the estimated force along axis", pair.estimated));
    MBK_TRY(finite("the measured force along axis", pair.measured));
    MBK_TRY(finite("the velocity of joint", pair.joint_velocity));
    rows += pair.estimated.rows();
  }
  if (rows < 2) return bad_data(fmt::format("{} rows are too few to compare forces", rows), "choose a longer window");
  return {};
}

/// Marks the rows about every reversal of one joint.
void mark_reversals(const Eigen::Ref<const Vector>& velocity, double rest_speed, Index window,
                    std::vector<Part>& parts) {
  Index last = -1;  // row at which the joint last moved
  for (Index i = 0; i < velocity.size(); ++i) {
    if (!(std::abs(velocity[i]) > rest_speed)) continue;
    if (last >= 0 && velocity[i] * velocity[last] < 0.0 && i - last <= 2 * window + 1) {
      Index first_change = -1, last_change = -1;
      for (Index k = last; k < i; ++k) {
        if (velocity[k] * velocity[i] <= 0.0 && velocity[k + 1] * velocity[i] > 0.0) {
          if (first_change < 0) first_change = k;
          last_change = k + 1;
        }
      }
      const Index middle = (first_change + last_change) / 2;
      const Index end = std::min(velocity.size() - 1, middle + window);
      for (Index k = std::max(Index{0}, middle - window); k <= end; ++k) {
        parts[static_cast<std::size_t>(k)] = Part::reversal;
      }
    }
    last = i;
  }
}

std::vector<Part> parts_of(const Matrix& velocity, double rest_speed, Index window) {
  std::vector<Part> parts(static_cast<std::size_t>(velocity.rows()));
  for (Index i = 0; i < velocity.rows(); ++i) {
    const bool rests = (velocity.row(i).array().abs() <= rest_speed).all();
    parts[static_cast<std::size_t>(i)] = rests ? Part::rest : Part::motion;
  }
  for (Index joint = 0; joint < velocity.cols(); ++joint) {
    mark_reversals(velocity.col(joint), rest_speed, window, parts);
  }
  return parts;
}

/// Sums of an error over some rows.
class Agreement {
 public:
  explicit Agreement(Index axes) : sum_(Vector::Zero(axes)), squares_(Vector::Zero(axes)) {}
  void add(const Vector& error) {
    ++rows_;
    sum_ += error;
    squares_ += error.cwiseAbs2();
  }
  [[nodiscard]] ForceAgreement result() const {
    const double rows = rows_ == 0 ? kNaN : static_cast<double>(rows_);
    return {rows_, sum_ / rows, (squares_ / rows).cwiseSqrt()};
  }

 private:
  Index rows_ = 0;
  Vector sum_, squares_;
};

/// Of two columns of numbers, about their means.
double correlation(const Vector& a, const Vector& b) {
  const Eigen::ArrayXd from_a = a.array() - a.mean(), from_b = b.array() - b.mean();
  const double both = std::sqrt(from_a.square().sum() * from_b.square().sum());
  return both > 0.0 ? (from_a * from_b).sum() / both : kNaN;
}

/// The rows of all segments one after another; of each, `margin` rows at both ends left out, and then `shift` later.
Vector joined(const std::vector<ForcePair>& segments, Matrix ForcePair::*signal, Index axis, Index margin = 0,
              Index shift = 0) {
  Index rows = 0;
  for (const ForcePair& pair : segments) rows += std::max(Index{0}, pair.measured.rows() - 2 * margin);
  Vector all(rows);
  Index at = 0;
  for (const ForcePair& pair : segments) {
    const Index length = pair.measured.rows() - 2 * margin;
    if (length <= 0) continue;
    all.segment(at, length) = (pair.*signal).col(axis).segment(margin + shift, length);
    at += length;
  }
  return all;
}

struct Lag {
  double rows = kNaN, correlation = kNaN;
};

Lag lag_of(const std::vector<ForcePair>& segments, Index axis, Index longest) {
  const Vector measured = joined(segments, &ForcePair::measured, axis, longest);
  if (longest < 1 || measured.size() < 2) return {};
  Vector at(2 * longest + 1);
  for (Index shift = -longest; shift <= longest; ++shift) {
    at[shift + longest] = correlation(measured, joined(segments, &ForcePair::estimated, axis, longest, shift));
  }
  if (!at.allFinite()) return {};
  Index best = 0;
  at.maxCoeff(&best);
  if (best == 0 || best == at.size() - 1) return {};
  const double slope = 0.5 * (at[best + 1] - at[best - 1]), bend = at[best - 1] - 2.0 * at[best] + at[best + 1];
  const double beyond = bend < 0.0 ? -slope / bend : 0.0;
  return {static_cast<double>(best - longest) + beyond, at[best] + 0.5 * slope * beyond};
}

}  // namespace

Result<ForceComparison> compare_forces(const std::vector<ForcePair>& segments, double sample_time,
                                       const ForceComparisonOptions& options) {
  MBK_TRY(above_zero({{"sample time", sample_time, "s"}}));
  if (auto ok = not_negative({{"speed below which a joint is at rest", options.rest_speed, ""},
                              {"window about a reversal", options.reversal_window, "s"},
                              {"longest lag", options.longest_lag, "s"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  MBK_TRY(check(segments));

  const Index axes = segments.front().measured.cols();
  const auto in_rows = [&](double seconds) { return static_cast<Index>(std::llround(seconds / sample_time)); };
  Agreement all(axes), reversals(axes), rest(axes), motion(axes);
  for (const ForcePair& pair : segments) {
    const std::vector<Part> parts = parts_of(pair.joint_velocity, options.rest_speed, in_rows(options.reversal_window));
    for (Index i = 0; i < pair.measured.rows(); ++i) {
      const Vector error = (pair.estimated.row(i) - pair.measured.row(i)).transpose();
      const Part part = parts[static_cast<std::size_t>(i)];
      all.add(error);
      (part == Part::reversal ? reversals : part == Part::rest ? rest : motion).add(error);
    }
  }
  ForceComparison result;
  result.all = all.result();
  result.reversals = reversals.result();
  result.rest = rest.result();
  result.motion = motion.result();
  result.duration = sample_time * static_cast<double>(result.all.rows);
  result.rest_speed = options.rest_speed;
  result.reversal_window = options.reversal_window;
  result.longest_lag = options.longest_lag;
  for (Vector* one : {&result.measured_rms, &result.vaf, &result.correlation, &result.gain, &result.lag,
                      &result.correlation_at_lag}) {
    one->setConstant(axes, kNaN);
  }
  for (Index axis = 0; axis < axes; ++axis) {
    const Vector estimated = joined(segments, &ForcePair::estimated, axis),
                 measured = joined(segments, &ForcePair::measured, axis);
    const Eigen::ArrayXd about = measured.array() - measured.mean();
    result.measured_rms[axis] = numeric::root_mean_square(about);
    result.vaf[axis] = numeric::variance_accounted_for(measured, measured - estimated);
    result.correlation[axis] = correlation(measured, estimated);
    if (result.measured_rms[axis] > 0.0) {
      result.gain[axis] = (about * (estimated.array() - estimated.mean())).sum() / about.square().sum();
    }
    const Lag lag = lag_of(segments, axis, in_rows(options.longest_lag));
    result.lag[axis] = sample_time * lag.rows;
    result.correlation_at_lag[axis] = lag.correlation;
  }
  return result;
}

}  // namespace mbk::analyse
