#include "mbk/measure/explore/after_onset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/units.h"
#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/reference_onsets.h"

namespace mbk::explore {
namespace {

constexpr double kBaseline = 0.1;    ///< [s]
constexpr double kSmoothing = 0.03;  ///< [s], between the first and the last sample of the filter
constexpr int kOrder = 4;
constexpr Index kMinOnsets = 4;  ///< for each axis
/// Largest motion in the time before an onset, of that after it: above it, the limb did not rest.
constexpr double kRest = 0.5;
constexpr double kNarrow = 0.5;  ///< half width of the interval of an eigenvalue, of the largest one

/// The moment after one onset, less the mean before it.
struct Response {
  Matrix motion;      ///< N×3n, [Δẍ Δẋ Δx]
  Matrix force;       ///< N×n, −ΔF_h
  Vector step;        ///< n
  double way = 0;     ///< largest |Δx|
  double before = 0;  ///< the same in the time before the onset
};

/// Counts in samples.
struct Lengths {
  dsp::SavitzkyGolay filter;
  Index baseline = 0, window = 0;
  /// Before the onset: the first sample of the first filter window.
  [[nodiscard]] Index before() const { return baseline + 2 * filter.half_window(); }
};

Lengths lengths_of(double sample_time, double window_s) {
  Lengths lengths;
  const auto half = static_cast<int>(std::max(std::lround(0.5 * kSmoothing / sample_time), 3L));
  lengths.filter = {kOrder, 2 * half + 1};
  lengths.baseline = std::llround(kBaseline / sample_time);
  lengths.window = std::llround(window_s / sample_time);
  return lengths;
}

Result<Response> response_after(const ExplorationTrial& trial, const Onset& onset, const Lengths& lengths) {
  const Index n = trial.axes, first = onset.sample - lengths.before(), half = lengths.filter.half_window();
  const auto rows = Eigen::seqN(first, lengths.before() + lengths.window);
  Matrix both(rows.size(), 2 * n);
  both << trial.input(rows, Eigen::all), trial.output(rows, Eigen::all);
  const Hertz rate(1.0 / trial.sample_time);
  Matrix smooth;  // row k is sample first + half + k
  for (int derivative = 2; derivative >= 0; --derivative) {
    const auto part =
        MBK_TRY(dsp::savitzky_golay(lengths.filter, derivative, derivative > 0 ? both.leftCols(n) : both, rate));
    smooth.conservativeResize(part.rows(), smooth.cols() + part.cols());
    smooth.rightCols(part.cols()) = part;
  }
  // Windows of the first rows end before the onset.
  const Vector mean = smooth.topRows(lengths.baseline).colwise().mean();
  smooth.rowwise() -= mean.transpose();
  Response response;
  const Index after = smooth.rows() - (onset.sample - first - half);
  response.motion = smooth.bottomRows(after).leftCols(3 * n);
  response.force = smooth.bottomRows(after).rightCols(n);
  response.step = onset.step;
  const auto largest = [&](const auto& place) { return std::sqrt(place.rowwise().squaredNorm().maxCoeff()); };
  response.way = largest(response.motion.rightCols(n));
  response.before = largest(smooth.topRows(lengths.baseline).middleCols(2 * n, n));
  return response;
}

/// Sums over onsets g of w_g(t) = [−ΔF_h, Δẍ, Δẋ, Δx](t) and the steps u_g, from which the estimate follows.
class OnsetSums {
 public:
  explicit OnsetSums(const Response& like)
      : n_(like.step.size()),
        steps_(Matrix::Zero(n_, n_)),
        squares_(Matrix::Zero(4 * n_, 4 * n_)),
        moved_(static_cast<std::size_t>(n_), Matrix::Zero(like.motion.rows(), 4 * n_)),
        own_(static_cast<std::size_t>(n_ * n_), squares_) {}

  /// @param sign  1, or −1 to take an onset out again
  void add(const Response& one, double sign) {
    Matrix w(one.motion.rows(), 4 * n_);
    w << one.force, one.motion;
    const Matrix square = w.transpose() * w;
    count_ += sign;
    steps_ += sign * one.step * one.step.transpose();
    squares_ += sign * square;
    for (Index j = 0; j < n_; ++j) {
      moved_[place(j)] += sign * one.step[j] * w;
      for (Index i = 0; i < n_; ++i) own_[place(i + n_ * j)] += sign * one.step[i] * one.step[j] * square;
    }
  }

  /// θ, 3n×n; not finite where the motion does not tell M, B and K apart.
  [[nodiscard]] Matrix coefficients() const {
    const Matrix weights = numeric::inverse(steps_);
    Matrix A = Matrix::Zero(4 * n_, 4 * n_);  // Σ_{g≠h} u_gᵀ (Σ u uᵀ)⁻¹ u_h w_gᵀ w_h
    for (Index i = 0; i < n_; ++i) {
      for (Index j = 0; j < n_; ++j) {
        A += weights(i, j) * (moved_[place(i)].transpose() * moved_[place(j)] - own_[place(i + n_ * j)]);
      }
    }
    A = (0.5 * (A + A.transpose())).eval();
    const Vector unit = squares_.diagonal().cwiseSqrt().cwiseInverse();
    Matrix theta(3 * n_, n_);
    for (Index k = 0; k < n_; ++k) {
      std::vector<Index> columns = {k};
      for (Index l = n_; l < 4 * n_; ++l) columns.push_back(l);
      const Vector scale = unit(columns);
      const Matrix a = scale.asDiagonal() * A(columns, columns) * scale.asDiagonal();
      const Matrix h = scale.asDiagonal() * squares_(columns, columns) * scale.asDiagonal();
      const double least = numeric::generalized_symmetric_eigen(a, h).values[0], part = (1.0 - least) / count_;
      const Matrix left = a - (least - part) / (1.0 - part) * h;
      const Index p = 3 * n_;
      theta.col(k) =
          numeric::Lu(left.bottomRightCorner(p, p)).solve(left.col(0).tail(p)).cwiseProduct(scale.tail(p)) / scale[0];
    }
    return theta;
  }

 private:
  static std::size_t place(Index index) { return static_cast<std::size_t>(index); }

  Index n_;
  double count_ = 0.0;
  Matrix steps_, squares_;     ///< Σ u uᵀ, Σ wᵀw
  std::vector<Matrix> moved_;  ///< Σ u[j] w
  std::vector<Matrix> own_;    ///< Σ u[i] u[j] wᵀw
};

/// Whether each axis is stepped along by some of the onsets, also without any one of them.
bool steps_along_all_axes(const std::vector<Response>& responses) {
  const Index n = responses.front().step.size();
  if (n == 1) return true;
  Matrix steps = Matrix::Zero(n, n);
  for (const Response& one : responses) steps += one.step * one.step.transpose();
  constexpr double kAlongOneLine = 0.01;
  return std::ranges::all_of(responses, [&](const Response& one) {
    const Vector values = numeric::symmetric_eigenvalues(steps - one.step * one.step.transpose());
    return values[0] > kAlongOneLine * values[n - 1];
  });
}

/// @param theta 3n×n    @param covariance of its stacked columns    @param part 0, 1, 2 for M, B, K
MatrixEstimate estimate_of(const Matrix& theta, const Matrix& covariance, Index part, double handle, double quantile) {
  const Index n = theta.cols(), p = theta.rows();
  MatrixEstimate estimate;
  estimate.value = theta.middleRows(part * n, n).transpose();
  estimate.value.diagonal().array() -= handle;
  std::vector<Index> places;  // of the entries of the matrix, columns stacked, in the covariance
  for (Index j = 0; j < n; ++j) {
    for (Index i = 0; i < n; ++i) places.push_back(i * p + part * n + j);
  }
  const Matrix V = covariance(places, places);
  estimate.half_width = quantile * V.diagonal().cwiseMax(0.0).cwiseSqrt().reshaped(n, n);
  const auto [values, vectors] = numeric::symmetric_eigen(0.5 * (estimate.value + estimate.value.transpose()));
  estimate.eigenvalue = values;
  estimate.eigenvalue_half_width.resize(n);
  for (Index k = 0; k < n; ++k) {  // dλ = vᵀ dZ v
    const Vector gradient = (vectors.col(k) * vectors.col(k).transpose()).reshaped();
    estimate.eigenvalue_half_width[k] = quantile * std::sqrt(std::max(0.0, gradient.dot(V * gradient)));
  }
  estimate.identifiable = values[n - 1] > 0.0 && estimate.eigenvalue_half_width.maxCoeff() < kNarrow * values[n - 1];
  return estimate;
}

/// The mass that all trials name; 0 where they do not.
double handle_mass_of(std::span<const ExplorationTrial> trials) {
  const auto first = trials.front().recorded_handle_mass;
  const bool one = first && std::ranges::all_of(trials, [&](const ExplorationTrial& trial) {
                     return trial.recorded_handle_mass == first && trial.motion == Motion::translation;
                   });
  return one ? *first : 0.0;
}

}  // namespace

Result<AfterOnsetEstimate> after_onset(std::span<const ExplorationTrial> trials, double window_s) {
  if (trials.empty()) return bad_usage("no trial was given");
  if (!(window_s > 2.0 * kSmoothing)) {
    return bad_usage(fmt::format("a window of {:g} ms after an onset is too short for a filter of {:g} ms",
                                 1e3 * window_s, 1e3 * kSmoothing),
                     "choose 100 to 200 ms");
  }
  AfterOnsetEstimate found;
  found.axes = trials.front().axes;
  found.window_s = window_s;
  found.baseline_s = kBaseline;
  const Index n = found.axes;
  std::vector<Response> responses;
  Index seen = 0;
  std::optional<Lengths> lengths;
  for (const ExplorationTrial& trial : trials) {
    if (trial.axes != found.axes) return bad_data("trials of one axis and of two cannot be explored together");
    if (trial.reference.size() == 0) {
      return bad_data("no reference was recorded, so there are no onsets",
                      "record the perturbation as channel reference (xr, yr), or omit --after-onset");
    }
    const Lengths own = lengths_of(trial.sample_time, window_s);
    if (lengths && lengths->window != own.window)
      return bad_data("the trials have different sample rates", "use --resample");
    lengths = own;
    for (const Onset& onset : reference_onsets(trial.reference, own.before())) {
      ++seen;
      if (onset.sample < own.before() || onset.sample + own.window > trial.samples()) continue;
      auto response = MBK_TRY(response_after(trial, onset, own));
      if (response.before > kRest * response.way) continue;
      responses.push_back(std::move(response));
    }
  }
  found.onsets = static_cast<Index>(responses.size());
  found.omitted = seen - found.onsets;
  if (found.onsets < kMinOnsets * n) {
    if (seen == 0) {
      return bad_data(
          fmt::format("the reference has no steps or pulses after {:.0f} ms of rest; at least {} are needed",
                      1e3 * kBaseline, kMinOnsets * n),
          "perturb with steps or pulses, with pauses between them");
    }
    return bad_data(fmt::format("the reference has {} onset{} after {:.0f} ms of rest, and the limb rested before {} "
                                "of them: at least {} are needed",
                                seen, seen == 1 ? "" : "s", 1e3 * kBaseline, found.onsets, kMinOnsets * n),
                    "perturb with steps or pulses, with pauses between them, or pool FILEs of one condition");
  }
  if (!steps_along_all_axes(responses)) {
    return bad_data("the reference steps along one line only, so the other axis is not identifiable",
                    "perturb in several directions, or explore one axis: --axes 1");
  }

  OnsetSums sums(responses.front());
  for (const Response& one : responses) {
    sums.add(one, 1.0);
    found.displacement += one.way / static_cast<double>(found.onsets);
  }
  const Matrix theta = sums.coefficients();
  if (!theta.allFinite()) return bad_data("the motion after the onsets does not distinguish M, B and K");
  Matrix covariance = Matrix::Zero(3 * n * n, 3 * n * n);
  for (const Response& one : responses) {
    OnsetSums rest = sums;
    rest.add(one, -1.0);
    const Vector change = (rest.coefficients() - theta).reshaped();
    covariance += change * change.transpose();
  }
  const auto count = static_cast<double>(found.onsets);
  covariance *= (count - 1.0) / count;
  found.degrees_of_freedom = std::floor(count / static_cast<double>(n)) - 1.0;
  const double quantile = numeric::student_quantile(0.975, static_cast<int>(found.degrees_of_freedom));
  found.handle_mass = handle_mass_of(trials);
  found.M = estimate_of(theta, covariance, 0, found.handle_mass, quantile);
  found.B = estimate_of(theta, covariance, 1, 0.0, quantile);
  found.K = estimate_of(theta, covariance, 2, 0.0, quantile);
  for (Index i = 0; i < n; ++i) {
    double power = 0.0, rest = 0.0;
    Index rows = 0;
    for (const Response& one : responses) {
      power += one.force.col(i).squaredNorm();
      rest += (one.force.col(i) - one.motion * theta.col(i)).squaredNorm();
      rows += one.force.rows();
    }
    found.explained.push_back({100.0 * (1.0 - rest / power), kNaN, std::sqrt(rest / static_cast<double>(rows))});
  }
  return found;
}

}  // namespace mbk::explore
