#include "mbk/measure/identify/missing_dynamics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::identify {
namespace {

constexpr double kChance = 1e-5;             ///< of an assumption that holds to be called contradicted, each
constexpr double kChanceOfTrend = 1e-2;      ///< where the noise is 1/f; of white noise far less
constexpr double kRowsPerBand = 2.6;         ///< rate of the rows over the top of the band: no more holds anything
constexpr double kBack = 1.4, kAhead = 0.5;  ///< what of the reference explains the motion of one instant [s]
constexpr Index kRowsPerLag = 5;
constexpr double kRidge = 1e-9;
constexpr double kMaxLeverage = 0.9;
constexpr Index kMaxOrder = 25;     ///< of the autoregression
constexpr double kExplained = 0.5;  ///< share of the motion that the reference must explain to stand for it
constexpr double kShareOfForce =
    0.002;                           ///< that matters where no reference is known: noise in a loop explains half of it
constexpr double kHardening = 0.05;  ///< of the stiffness, at the amplitude of the motion
constexpr double kChangeOfStiffness = 0.1, kChangeOfDamping = 0.1;
constexpr double kMemory = 0.03;                          ///< of the force, root mean square
constexpr double kEven = 0.06;                            ///< likewise: the geometry of an arm is quadratic, too
constexpr std::array kRelaxationTimes = {0.1, 0.5, 1.5};  ///< τ [s] of what lags behind the position
constexpr Index kWaves = 12;                              ///< slow cosines, the fastest of about 0.1 Hz in a minute
constexpr Index kTrend = 1, kBesideTrend = 9;

/// Motion row by row: what was measured, or what the reference explains of it.
struct Motion {
  Matrix jerk, acceleration, velocity, position;
  Matrix lagging;  ///< position behind 1/(1 + sτ), each τ
};

Matrix unit_velocity(const Matrix& velocity) {
  constexpr double kSlow = 0.3;  // of the mean speed: dry friction has no corner after the filters
  const Vector speed = velocity.rowwise().norm();
  const double slow = kSlow * speed.mean();
  return (speed.array().square() + slow * slow).sqrt().inverse().matrix().asDiagonal() * velocity;
}

/// |ẋ_i| and x_i x_j.
Matrix even_part(const Motion& motion) {
  const Index n = motion.position.cols();
  Matrix even(motion.position.rows(), n + n * (n + 1) / 2);
  even.leftCols(n) = motion.velocity.cwiseAbs();
  Index column = n;
  for (Index i = 0; i < n; ++i) {
    for (Index j = i; j < n; ++j) {
      even.col(column++) = motion.position.col(i).cwiseProduct(motion.position.col(j));
    }
  }
  return even;
}

/// What each assumption excludes, for one axis of the force.
/// @param stiffness, damping n, the axis' rows of K and B    @param wave N×k, cosines of time
Matrix excluded(Assumption assumption, const Motion& motion, const Vector& stiffness, const Vector& damping,
                const Matrix& waves) {
  switch (assumption) {
    case Assumption::simultaneous:
      return motion.jerk;
    case Assumption::linear_stiffness:
      return motion.position.rowwise().squaredNorm().asDiagonal() * motion.position;
    case Assumption::no_dry_friction:
      return unit_velocity(motion.velocity);
    case Assumption::constant_stiffness:
      return (motion.position * stiffness).asDiagonal() * waves;
    case Assumption::constant_damping:
      return (motion.velocity * damping).asDiagonal() * waves;
    case Assumption::no_memory:
      return motion.lagging;
    case Assumption::alike_both_ways:
      return even_part(motion);
    default:
      return {};
  }
}

/// One axis of the force by instrumental variables, in whitened rows.
struct AxisFit {
  Vector coefficients;   ///< of [ẍ ẋ x 1] and what was added
  Vector without;        ///< of [ẍ ẋ x 1] alone
  double statistic = 0;  ///< Wald's, of the last columns, over their number
  double freedom = 0;    ///< rows less coefficients
  Matrix covariance;     ///< of the last coefficients
  double gain = 0;       ///< variance of the force that the last columns explain, as a share
};

class Tester {
 public:
  Tester(const Regression& r, const Matrix& coefficients, const Matrix& errors, double band,
         const std::vector<RowRange>& ranges)
      : r_(r), ranges_(ranges), n_(r.axes()), coefficients_(coefficients), errors_(errors) {
    thin(band);
    if (!enough_rows()) return;
    waves_ = cosines(rows(), std::min(kWaves, rows() / 40));
    explain();
  }

  [[nodiscard]] TestedAssumptions run() {
    if (!enough_rows()) return {};
    std::vector<AssumptionTest> tests = test_dynamics();
    tests.push_back(test_trend());
    return {std::move(tests), curvature_};
  }

 private:
  [[nodiscard]] Index rows() const { return static_cast<Index>(at_.size()); }
  [[nodiscard]] bool enough_rows() const { return rows() >= 100; }

  /// As many rows as the band needs; at the ends of a range there is no jerk.
  void thin(double band) {
    step_ = std::max<Index>(1, std::floor(1.0 / (kRowsPerBand * band * r_.sample_time)));
    for (const RowRange& range : ranges_) {
      const Index first = rows();
      for (Index i = range.begin + 1; i + 1 < range.end; i += step_) {
        at_.push_back(i);
        range_of_.push_back(range);
      }
      if (rows() > first) pieces_.push_back({first, rows()});
    }
    if (!enough_rows()) return;
    measured_ = {Matrix(rows(), n_), Matrix(rows(), n_), Matrix(rows(), n_), Matrix(rows(), n_), lagging_position()};
    force_.resize(rows(), n_);
    for (Index k = 0; k < rows(); ++k) {
      const Index i = at_[static_cast<std::size_t>(k)];
      measured_.jerk.row(k) = (r_.Z.row(i + 1) - r_.Z.row(i - 1)).head(n_) / (2.0 * r_.sample_time);
      measured_.acceleration.row(k) = r_.Z.row(i).head(n_);
      measured_.velocity.row(k) = r_.Z.row(i).segment(n_, n_);
      measured_.position.row(k) = r_.Z.row(i).segment(2 * n_, n_);
      force_.row(k) = r_.Y.row(i);
    }
    measured_.position.rowwise() -= measured_.position.colwise().mean().eval();
  }

  /// The position behind 1/(1 + sτ) at the decimated rows, from rest at the beginning of each range.
  [[nodiscard]] Matrix lagging_position() const {
    constexpr std::size_t kCount = kRelaxationTimes.size();
    Matrix lagging(rows(), static_cast<Index>(kCount) * n_);
    for (std::size_t k = 0; k < kCount; ++k) {
      const double keep = std::exp(-r_.sample_time / kRelaxationTimes[k]);
      for (Index axis = 0; axis < n_; ++axis) {
        Index next = 0;
        double state = 0.0;
        for (const RowRange& range : ranges_) {
          for (Index i = range.begin; i < range.end && next < rows(); ++i) {
            const double x = r_.Z(i, 2 * n_ + axis);
            state = i == range.begin ? x : x + keep * (state - x);
            if (at_[static_cast<std::size_t>(next)] == i) lagging(next++, static_cast<Index>(k) * n_ + axis) = state;
          }
        }
      }
    }
    return lagging.rowwise() - lagging.colwise().mean().eval();
  }

  /// cos jφ of j = 1 … count, φ over half a turn; from the first by cos (j+1)φ = 2 cos φ cos jφ − cos (j−1)φ.
  [[nodiscard]] static Matrix cosines(Index rows, Index count) {
    Matrix waves(rows, count);
    if (count == 0) return waves;
    for (Index k = 0; k < rows; ++k) {
      waves(k, 0) = std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(rows));
    }
    for (Index j = 1; j < count; ++j) {
      waves.col(j) = 2.0 * waves.col(0).cwiseProduct(waves.col(j - 1));
      if (j == 1) {
        waves.col(j).array() -= 1.0;
      } else {
        waves.col(j) -= waves.col(j - 2);
      }
    }
    return waves;
  }

  /// The reference around each row. Before a range it is at its mean, so that a step with which the range begins is
  /// one; after it, it stays as it is.
  [[nodiscard]] Matrix reference_around() const {
    const double dt = static_cast<double>(step_) * r_.sample_time;
    const Index most = std::max<Index>(2, rows() / (2 * kRowsPerLag * n_));
    const Index requested = std::llround((kBack + kAhead) / dt) + 1;
    const Index lags = std::min(most, requested),
                ahead = std::llround(kAhead / (kBack + kAhead) * static_cast<double>(lags));
    Matrix around = Matrix::Zero(rows(), lags * n_);
    const auto reference = r_.perturbation();
    for (Index k = 0; k < rows(); ++k) {
      const auto place = static_cast<std::size_t>(k);
      for (Index lag = 0; lag < lags; ++lag) {
        const Index i = at_[place] + (ahead - lag) * step_;
        if (i < range_of_[place].begin) break;
        around.row(k).segment(lag * n_, n_) = reference.row(std::min(i, range_of_[place].end - 1));
      }
    }
    return around.rowwise() - around.colwise().mean().eval();
  }

  /// Motion as the reference explains it. Where it explains little, or none is known, the motion stands for itself.
  void explain() {
    explained_ = measured_;
    if (r_.reference.size() == 0) return;
    const Matrix X = reference_around();
    const Index half = rows() / 2, rest = rows() - half;
    const Index lags = measured_.lagging.cols(), columns = 4 * n_ + lags;
    Matrix motion(rows(), columns);
    motion << measured_.jerk, measured_.acceleration, measured_.velocity, measured_.position, measured_.lagging;
    const auto response = [&](Index from, Index count) {
      const auto part = X.middleRows(from, count);
      Matrix gram = numeric::gram_of({part});
      gram.diagonal().array() += kRidge * gram.trace() / static_cast<double>(gram.rows());
      return Matrix(numeric::PivotedCholesky(gram).solve(numeric::products_of(part, motion.middleRows(from, count))));
    };
    const auto answer = [&](const auto& reference, const Matrix& coefficients) {
      return numeric::residuals_of({reference}, Matrix::Zero(reference.rows(), columns), -coefficients);
    };
    Matrix explained(rows(), columns);
    explained.topRows(half) = answer(X.topRows(half), response(half, rest));
    explained.bottomRows(rest) = answer(X.bottomRows(rest), response(0, half));
    for (Index axis = 0; axis < n_; ++axis) {
      const double moved = numeric::variance(measured_.position.col(axis));
      const double left = numeric::variance(measured_.position.col(axis) - explained.col(3 * n_ + axis));
      if (!(left < (1.0 - kExplained) * moved)) return;
    }
    by_reference_ = true;
    explained_ = {explained.leftCols(n_), explained.middleCols(n_, n_), explained.middleCols(2 * n_, n_),
                  explained.middleCols(3 * n_, n_), explained.rightCols(lags)};
    explained_.position.rowwise() -= explained_.position.colwise().mean().eval();
  }

  [[nodiscard]] Vector stiffness(Index axis) const { return coefficients_.col(axis).segment(2 * n_, n_); }
  [[nodiscard]] Vector damping(Index axis) const { return coefficients_.col(axis).segment(n_, n_); }

  /// Of what the assumption excludes, for one axis of the force.
  [[nodiscard]] Index columns_of(Assumption assumption) const {
    switch (assumption) {
      case Assumption::constant_stiffness:
      case Assumption::constant_damping:
        return waves_.cols();
      case Assumption::no_memory:
        return measured_.lagging.cols();
      case Assumption::alike_both_ways:
        return n_ + n_ * (n_ + 1) / 2;
      default:
        return n_;
    }
  }

  /// [ẍ ẋ x 1] and what the assumptions exclude.
  [[nodiscard]] Matrix regressors(const Motion& motion, const std::vector<Assumption>& added, Index axis) const {
    Matrix Z(rows(), 3 * n_ + 1);
    Z << motion.acceleration, motion.velocity, motion.position, Vector::Ones(rows());
    for (const Assumption assumption : added) {
      const Matrix more = excluded(assumption, motion, stiffness(axis), damping(axis), waves_);
      Z.conservativeResize(Eigen::NoChange, Z.cols() + more.cols());
      Z.rightCols(more.cols()) = more;
    }
    return Z;
  }

  /// e_t + c₁ e_{t−1} + … of every column; the first rows of each piece are lost.
  [[nodiscard]] Matrix whitened(const Matrix& columns, const Vector& filter) const {
    const Index order = filter.size() - 1;
    Index count = 0;
    for (const RowRange& piece : pieces_) count += std::max<Index>(0, piece.size() - order);
    Matrix result(count, columns.cols());
    Index row = 0;
    for (const RowRange& piece : pieces_) {
      const Index size = piece.size() - order;
      if (size <= 0) continue;
      for (Index j = 0; j < columns.cols(); ++j) {
        const auto before = [&](Index lag) { return columns.col(j).segment(piece.begin + order - lag, size); };
        std::vector<numeric::MatrixPart> past;
        for (Index lag = 1; lag <= order; ++lag) past.emplace_back(before(lag));
        result.col(j).segment(row, size) = numeric::residuals_of(past, before(0), -filter.tail(order));
      }
      row += size;
    }
    return result;
  }

  [[nodiscard]] Vector noise_of(const Vector& residual) const {
    std::vector<Vector> pieces;
    Index shortest = rows();
    for (const RowRange& piece : pieces_) {
      pieces.push_back(residual.segment(piece.begin, piece.size()));
      shortest = std::min(shortest, piece.size());
    }
    return dsp::autoregression(pieces, std::min(kMaxOrder, shortest / 3));
  }

  /// @param last  columns at the end that are tested
  [[nodiscard]] std::optional<AxisFit> fit(Matrix A, Matrix R, const Vector& y, Index last) const {
    const Index p = A.cols(), base = p - last;
    const Vector scale = A.colwise().norm();
    if (!(scale.minCoeff() > 0.0) || rows() < 4 * p) return std::nullopt;
    A = A * scale.cwiseInverse().asDiagonal();
    R = R * scale.cwiseInverse().asDiagonal();
    const auto solved = [](const numeric::MatrixPart& of, const numeric::MatrixPart& by, const Vector& to) {
      return Vector(numeric::Lu(numeric::products_of(by, of)).solve(numeric::products_of(by, to)));
    };
    Vector b = solved(A, R, y);
    Matrix Aw, Rw;
    Vector yw;
    for (int pass = 0; pass < 2; ++pass) {
      Aw = Rw = Matrix();  // before there is another
      const Vector e = y - A * b;
      const Vector filter = noise_of(e.array() - e.mean());
      Aw = whitened(A, filter);
      Rw = whitened(R, filter);
      yw = whitened(y, filter);
      b = solved(Aw, Rw, yw);
    }
    R = Matrix();
    const auto count = static_cast<double>(Aw.rows());
    AxisFit result;
    result.freedom = count - static_cast<double>(p);
    if (!(result.freedom > 0.0)) return std::nullopt;
    const Matrix bread = numeric::inverse(numeric::products_of(Rw, Aw));
    // Each residual over 1 − its leverage: few rows carry the damping of a quick pulse, and a fit draws near them.
    const Vector leverage = (Aw * bread).cwiseProduct(Rw).rowwise().sum();
    const Vector residual = (yw - Aw * b).array() / (1.0 - leverage.array().min(kMaxLeverage));
    const Vector b0 = solved(Aw.leftCols(base), Rw.leftCols(base), yw);
    Rw.array().colwise() *= residual.array();  // the scores
    const Matrix V = bread * numeric::gram_of({Rw}) * bread.transpose();
    const Vector tested = b.tail(last);
    result.statistic =
        tested.dot(numeric::PivotedCholesky(V.bottomRightCorner(last, last)).solve(tested)) / static_cast<double>(last);
    const Vector unscaled = scale.tail(last).cwiseInverse();
    result.covariance = unscaled.asDiagonal() * V.bottomRightCorner(last, last) * unscaled.asDiagonal();
    const double power = numeric::variance(y);
    result.gain = (numeric::variance(y - A.leftCols(base) * b0) - numeric::variance(y - A * b)) / power;
    result.coefficients = b.cwiseQuotient(scale);
    result.without = b0.cwiseQuotient(scale.head(base)).head(3 * n_);
    if (!result.coefficients.allFinite() || !std::isfinite(result.statistic)) return std::nullopt;
    return result;
  }

  /// All axes with one more kind of dynamics; absent where the rows do not tell it from the rest.
  [[nodiscard]] std::optional<AssumptionTest> test(Assumption assumption, std::vector<Assumption> model) {
    model.push_back(assumption);
    AssumptionTest result{assumption};
    const Index last = columns_of(assumption);
    std::vector<AxisFit> fits;
    double gain = 0.0;
    for (Index axis = 0; axis < n_; ++axis) {
      auto one = fit(regressors(measured_, model, axis), regressors(explained_, model, axis), force_.col(axis), last);
      if (!one) return std::nullopt;
      const double chance = numeric::f_probability_above(one->statistic, static_cast<double>(last), one->freedom);
      result.p_value = std::min(result.p_value, static_cast<double>(n_) * chance);
      gain = std::max(gain, one->gain);
      for (Index k = 0; k < 3 * n_; ++k) {
        const double half_width = numeric::kNormal95 * errors_(k, axis);
        result.shift = std::max(result.shift, std::abs(one->coefficients[k] - one->without[k]) / half_width);
      }
      fits.push_back(std::move(*one));
    }
    if (assumption == Assumption::alike_both_ways) note_curvature(fits);
    result.size = beside_linear(assumption) ? std::sqrt(std::max(0.0, gain)) : size_of(assumption, fits);
    result.contradicted = result.p_value < kChance && matters(result) && (by_reference_ || gain > kShareOfForce);
    return result;
  }

  /// The force that γ of x_i x_j adds on average, without what the noise of γ adds to its square.
  void note_curvature(const std::vector<AxisFit>& fits) {
    const Matrix even = even_part(measured_);
    const Index squares = even.cols() - n_;
    const Vector mean = even.rightCols(squares).colwise().mean();
    curvature_.resize(n_);
    for (Index axis = 0; axis < n_; ++axis) {
      const AxisFit& fit = fits[static_cast<std::size_t>(axis)];
      const double force = mean.dot(fit.coefficients.tail(squares));
      const double chance = mean.dot(fit.covariance.bottomRightCorner(squares, squares) * mean);
      curvature_[axis] = std::sqrt(std::max(0.0, force * force - chance));
    }
  }

  /// Whether the size is that of the force which W explains.
  [[nodiscard]] static bool beside_linear(Assumption assumption) {
    return assumption == Assumption::no_memory || assumption == Assumption::alike_both_ways;
  }

  [[nodiscard]] static bool matters(const AssumptionTest& found) {
    if (found.assumption == Assumption::constant_stiffness) return found.size > kChangeOfStiffness;
    if (found.assumption == Assumption::constant_damping) return found.size > kChangeOfDamping;
    if (found.assumption == Assumption::alike_both_ways) return found.size > kEven;
    if (found.assumption == Assumption::no_memory) return found.size > kMemory && found.shift > 1.0;
    if (found.assumption == Assumption::linear_stiffness && std::abs(found.size) < kHardening) return false;
    return found.shift > 1.0;
  }

  [[nodiscard]] double size_of(Assumption assumption, const std::vector<AxisFit>& fits) const {
    const Index tested = columns_of(assumption);
    Matrix M(n_, n_), K(n_, n_), added(n_, tested);
    for (Index axis = 0; axis < n_; ++axis) {
      const Vector& b = fits[static_cast<std::size_t>(axis)].coefficients;
      M.row(axis) = b.head(n_);
      K.row(axis) = b.segment(2 * n_, n_);
      added.row(axis) = b.tail(tested);
    }
    switch (assumption) {
      case Assumption::simultaneous:  // −τ M
        return -added.cwiseProduct(M).sum() / M.squaredNorm();
      case Assumption::linear_stiffness:
        return added.cwiseProduct(K).sum() / K.squaredNorm() * measured_.position.rowwise().squaredNorm().mean();
      case Assumption::no_dry_friction:
        return added.trace() / static_cast<double>(n_) * unit_velocity(measured_.velocity).rowwise().norm().mean();
      default:
        return std::sqrt(0.5 * added.rowwise().squaredNorm().maxCoeff());
    }
  }

  /// The most certain first; what was found belongs to the model of the others.
  [[nodiscard]] std::vector<AssumptionTest> test_dynamics() {
    using enum Assumption;
    std::vector<Assumption> open = {simultaneous,     linear_stiffness, no_dry_friction, constant_stiffness,
                                    constant_damping, no_memory,        alike_both_ways},
                            model;
    std::vector<AssumptionTest> tests;
    while (!open.empty()) {
      std::vector<AssumptionTest> now;
      for (const Assumption one : open) {
        if (auto tested = test(one, model)) now.push_back(*tested);
      }
      const auto first = std::ranges::min_element(now, [](const AssumptionTest& a, const AssumptionTest& b) {
        return std::pair(!a.contradicted, a.p_value) < std::pair(!b.contradicted, b.p_value);
      });
      if (first == now.end() || !first->contradicted) {
        tests.insert(tests.end(), now.begin(), now.end());
        break;
      }
      tests.push_back(*first);
      model.push_back(first->assumption);
      std::erase(open, first->assumption);
    }
    return tests;
  }

  /// Half a cosine over the whole recording against the faster ones, each weighed as noise of 1/f has it.
  [[nodiscard]] AssumptionTest test_trend() const {
    AssumptionTest result{Assumption::constant_rest};
    const Matrix waves = cosines(rows(), kBesideTrend);
    const double count = static_cast<double>(rows());
    Vector ramp(rows());
    for (Index k = 0; k < rows(); ++k) ramp[k] = (static_cast<double>(k) + 0.5) / count - 0.5;
    for (Index axis = 0; axis < n_; ++axis) {
      const Vector residual = residual_of(axis);
      const Vector heights = waves.transpose() * residual;
      double beside = 0.0;
      for (Index j = kTrend; j < kBesideTrend; ++j) beside += static_cast<double>(j + 1) * heights[j] * heights[j];
      beside /= static_cast<double>(kBesideTrend - kTrend);
      const double chance = numeric::f_probability_above(heights[0] * heights[0] / beside, 1.0,
                                                         static_cast<double>(kBesideTrend - kTrend));
      const double drift = -ramp.dot(residual) / ramp.squaredNorm();  // of F_h
      if (static_cast<double>(n_) * chance < result.p_value) {
        result.p_value = static_cast<double>(n_) * chance;
        result.size = drift;
        result.shift = 0.5 * std::abs(drift) / (numeric::kNormal95 * errors_(3 * n_, axis));
      }
    }
    result.contradicted = result.p_value < kChanceOfTrend && result.shift > 1.0;
    return result;
  }

  /// What the fit leaves of an axis, without its mean.
  [[nodiscard]] Vector residual_of(Index axis) const {
    const Matrix motion = regressors(measured_, {}, axis).leftCols(3 * n_);
    const Vector residual = force_.col(axis) - motion * coefficients_.col(axis).head(3 * n_);
    return residual.array() - residual.mean();
  }

  const Regression& r_;
  const std::vector<RowRange>& ranges_;
  Index n_, step_ = 1;
  Matrix coefficients_, errors_;
  std::vector<Index> at_;           ///< rows of the regression
  std::vector<RowRange> range_of_;  ///< and the range that each stands in
  std::vector<RowRange> pieces_;    ///< rows here without a break
  Motion measured_, explained_;
  Matrix force_, waves_;  ///< N×n, −F_h; N×k
  Vector curvature_;      ///< of TestedAssumptions
  bool by_reference_ = false;
};

}  // namespace

TestedAssumptions test_assumptions(const Regression& r, const Matrix& coefficients, const Matrix& errors, double band,
                                   const std::vector<RowRange>& ranges) {
  if (!(band > 0.0) || !coefficients.allFinite() || !(errors.array() > 0.0).all()) return {};
  return Tester(r, coefficients, errors, band, ranges).run();
}

}  // namespace mbk::identify
