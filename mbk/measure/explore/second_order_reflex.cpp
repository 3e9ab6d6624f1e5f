#include "mbk/measure/explore/second_order_reflex.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace {

/// Impulse response of 1/(s² + 2ζs + 1) at time t, in units of 1/ω.
double impulse(double t, double damping) {
  if (t <= 0.0) return 0.0;
  const double square = damping * damping - 1.0;
  if (std::abs(square) < 1e-8) return t * std::exp(-damping * t);
  if (square < 0.0) {
    const double w = std::sqrt(-square);
    return std::exp(-damping * t) * std::sin(w * t) / w;
  }
  const double w = std::sqrt(square);  // of two real poles: no difference of large numbers
  return (std::exp(-(damping - w) * t) - std::exp(-(damping + w) * t)) / (2.0 * w);
}

/// What is searched: ln ω, ln ζ, d.
using Shape = Eigen::Vector3d;

class Search {
 public:
  Search(const Matrix& directions, const Matrix& coefficients, const std::vector<Matrix>& covariance, double T,
         Index first)
      : T_(T), first_(first), lags_(directions.rows()) {
    for (Index j = 0; j < coefficients.cols(); ++j) {
      // C⁻¹ = UᵀU by the triangle of C
      const numeric::Cholesky triangle(covariance[static_cast<std::size_t>(j)]);
      usable_ = usable_ && triangle.positive_definite();
      if (!usable_) return;
      const Matrix lower = triangle.upper().transpose();
      weights_.push_back(lower.triangularView<Eigen::Lower>().solve(directions.transpose()));
      requested_.push_back(lower.triangularView<Eigen::Lower>().solve(coefficients.col(j)));
    }
  }
  [[nodiscard]] bool usable() const { return usable_; }

  struct Point {
    Shape shape;
    Vector gain;  ///< n
    Vector rest;  ///< of all axes under each other, whitened
    [[nodiscard]] double squares() const { return rest.squaredNorm(); }
  };

  /// At each lag, of unit gain: what answers an input that runs in straight lines between its samples is the response
  /// weighted by a triangle of ±T around the lag, here by Gauss–Legendre quadrature of four points on each side.
  [[nodiscard]] Vector response(const Shape& shape) const {
    constexpr std::array kNodes = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263};
    constexpr std::array kWeights = {0.17392742256872692, 0.3260725774312731, 0.3260725774312731, 0.17392742256872692};
    const double natural = std::exp(shape[0]), damping = std::exp(shape[1]);
    const auto at_time = [&](double t) { return natural * impulse(natural * (t - shape[2]), damping); };
    Vector g = Vector::Zero(lags_);
    for (Index k = 0; k < lags_; ++k) {
      const double lag = T_ * static_cast<double>(first_ + k);
      for (std::size_t q = 0; q < kNodes.size(); ++q) {
        const double weight = T_ * kWeights[q] * (1.0 - kNodes[q]), away = T_ * kNodes[q];
        g[k] += weight * (at_time(lag + away) + at_time(lag - away));
      }
    }
    return g;
  }

  /// The best gains for a shape.
  [[nodiscard]] Point at(const Shape& shape) const {
    const Vector g = response(shape);
    Point point{shape, Vector(requested_.size()), {}};
    std::vector<Vector> parts;
    Index rows = 0;
    for (std::size_t j = 0; j < requested_.size(); ++j) {
      const Vector made = weights_[j] * g;
      const double gain = made.squaredNorm() > 0.0 ? made.dot(requested_[j]) / made.squaredNorm() : 0.0;
      point.gain[static_cast<Index>(j)] = gain;
      parts.emplace_back(requested_[j] - gain * made);
      rows += made.size();
    }
    point.rest.resize(rows);
    Index row = 0;
    for (const Vector& part : parts) {
      point.rest.segment(row, part.size()) = part;
      row += part.size();
    }
    return point;
  }

  /// ∂rest/∂shape of the profiled gains, by central differences.
  [[nodiscard]] Matrix slope(const Point& point) const {
    Matrix J(point.rest.size(), 3);
    const Shape steps(1e-4, 1e-4, 0.02 * T_);
    for (Index k = 0; k < 3; ++k) {
      Shape up = point.shape, down = point.shape;
      up[k] += steps[k];
      down[k] -= steps[k];
      J.col(k) = (at(up).rest - at(down).rest) / (2.0 * steps[k]);
    }
    return J;
  }

  [[nodiscard]] Point from(const Shape& start) const {
    Point best = at(start);
    double damp = 1e-2;
    constexpr int kMaxSteps = 60;
    for (int step = 0; step < kMaxSteps; ++step) {
      const Matrix J = slope(best);
      Matrix H = J.transpose() * J;
      const Vector down = -(J.transpose() * best.rest);
      H.diagonal() *= 1.0 + damp;
      const Vector move = numeric::PivotedCholesky(H).solve(down);
      if (!move.allFinite()) break;
      const Point next = at(best.shape + Shape(move));
      if (next.squares() < best.squares()) {
        const double gained = best.squares() - next.squares();
        best = next;
        damp = std::max(1e-9, 0.3 * damp);
        if (gained < 1e-7 * best.squares()) break;
      } else {
        damp *= 5.0;
        if (damp > 1e8) break;
      }
    }
    return best;
  }

  /// Covariance of [G; ln ω; ln ζ; d].
  [[nodiscard]] Matrix covariance(const Point& point) const {
    const auto n = static_cast<Index>(requested_.size());
    Matrix J = Matrix::Zero(point.rest.size(), n + 3);
    const auto rest_with = [&](const Shape& shape, const Vector& gain) {
      const Vector g = response(shape);
      Vector rest(point.rest.size());
      Index row = 0;
      for (std::size_t j = 0; j < requested_.size(); ++j) {
        rest.segment(row, requested_[j].size()) = requested_[j] - gain[static_cast<Index>(j)] * (weights_[j] * g);
        row += requested_[j].size();
      }
      return rest;
    };
    for (Index j = 0; j < n; ++j) {
      J.col(j) = rest_with(point.shape, point.gain + Vector::Unit(n, j)) - rest_with(point.shape, point.gain);
    }
    const Shape steps(1e-4, 1e-4, 0.02 * T_);
    for (Index k = 0; k < 3; ++k) {
      Shape up = point.shape, down = point.shape;
      up[k] += steps[k];
      down[k] -= steps[k];
      J.col(n + k) = (rest_with(up, point.gain) - rest_with(down, point.gain)) / (2.0 * steps[k]);
    }
    return numeric::inverse(J.transpose() * J);
  }

 private:
  double T_;
  Index first_, lags_;
  bool usable_ = true;
  std::vector<Matrix> weights_;    ///< r×lags
  std::vector<Vector> requested_;  ///< r
};

}  // namespace

std::optional<SecondOrderReflex> fit_second_order(const Matrix& directions, const Matrix& coefficients,
                                                  const std::vector<Matrix>& covariance, double sample_time,
                                                  Index first, double freedom) {
  const Index n = coefficients.cols(), r = coefficients.rows();
  const double begin = sample_time * static_cast<double>(first);
  const double end = sample_time * static_cast<double>(first + directions.rows());
  const Search search(directions, coefficients, covariance, sample_time, first);
  if (!search.usable() || r * n <= n + 3) return std::nullopt;
  std::optional<Search::Point> best;
  for (const double natural : {8.0, 20.0, 50.0}) {
    for (const double damping : {0.5, 1.0}) {
      for (const double later : {0.0, 0.03, 0.08}) {
        const auto point = search.from(Shape(std::log(natural), std::log(damping), begin + later));
        const bool inside = std::isfinite(point.squares()) && point.shape[2] > 0.0 && point.shape[2] < end &&
                            std::exp(point.shape[0]) < std::numbers::pi / sample_time;
        if (inside && (!best || point.squares() < best->squares())) best = point;
      }
    }
  }
  if (!best) return std::nullopt;
  const double left = static_cast<double>(r * n - n - 3), statistic = best->squares() / left;
  const Vector deviation =
      search.covariance(*best).diagonal().cwiseMax(0.0).cwiseSqrt() * std::sqrt(std::max(1.0, statistic));
  if (!deviation.allFinite()) return std::nullopt;
  SecondOrderReflex reflex;
  for (Index j = 0; j < n; ++j) reflex.gain.push_back({best->gain[j], numeric::kNormal95 * deviation[j]});
  const double frequency = std::exp(best->shape[0]) / (2.0 * std::numbers::pi), damping = std::exp(best->shape[1]);
  reflex.frequency = {frequency, numeric::kNormal95 * frequency * deviation[n]};
  reflex.damping = {damping, numeric::kNormal95 * damping * deviation[n + 1]};
  reflex.delay = {best->shape[2], numeric::kNormal95 * deviation[n + 2]};
  reflex.p_value = numeric::f_probability_above(statistic, left, freedom);
  return reflex;
}

}  // namespace mbk::explore
