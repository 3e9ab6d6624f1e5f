#include "mbk/measure/explore/parallel_cascade.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/emg_path.h"
#include "mbk/measure/explore/lagged_regression.h"
#include "mbk/measure/explore/response_model.h"
#include "mbk/measure/explore/second_order_reflex.h"

namespace mbk::explore {
namespace {

constexpr double kIntrinsicMemory = 0.04;  ///< [s]: no reflex is as fast (Kearney, Stein & Parameswaran 1997)
constexpr double kEarliest = 0.04, kLatest = 0.2, kLongest = 0.99;  ///< lags of a reflex [s]
constexpr Index kFolds = 8;
constexpr Index kRowsOfCascade = 10;
constexpr double kChanceOfReflex = 0.001;  ///< of a linear limb to be credited with a reflex
/// Of the error that stretch in the opposite direction leaves, a reflex predicts a tenth more. Limbs of two links
/// without one: at most 0.04 (20 trials), since their geometry is not quite even; real ankles: 0.23 to 0.57.
constexpr double kOneSided = 0.1;
constexpr double kTestedLags = 0.04;  ///< [s], lags that are tested as one
constexpr Index kMaxOrder = 5;        ///< of the polynomial
constexpr int kMaxSwaps = 8;
constexpr double kSwapTolerance = 0.05;  ///< [% VAF]
constexpr Index kDirections = 8;         ///< in a plane

/// A signal, and what the reference explains of it (the same, where there is none).
struct Both {
  Matrix measured, explained;
};

std::vector<Vector> directions_of(Index axes) {
  if (axes == 1) return {Vector::Ones(1), -Vector::Ones(1)};
  std::vector<Vector> directions;
  if (axes == 3) {
    for (Index code = 0; code < 27; ++code) {
      const Eigen::Vector3d corner(static_cast<double>(code / 9 - 1), static_cast<double>(code / 3 % 3 - 1),
                                   static_cast<double>(code % 3 - 1));
      if (corner.norm() > 0.0) directions.emplace_back(corner.normalized());
    }
    return directions;
  }
  for (Index k = 0; k < kDirections; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(kDirections);
    directions.push_back(Vector{{std::cos(angle), std::sin(angle)}});
  }
  return directions;
}

class Cascade {
 public:
  explicit Cascade(const LimbSignals& signals)
      : s_(signals),
        n_(signals.axes),
        T_(signals.sample_time),
        L_(std::max<Index>(1, std::llround(kIntrinsicMemory / T_))),
        first_(std::max<Index>(L_, std::llround(kEarliest / T_))),
        last_(static_cast<Index>(std::floor(kLongest / T_ + 1e-9))) {}

  Result<ParallelCascadeEstimate> run() {
    result_.axes = s_.axes;
    result_.sample_time = T_;
    result_.instruments = s_.explained.size() > 0;
    result_.held_out = !s_.validation.empty();
    if (T_ > kEarliest) {
      result_.found = DelayedResponse::not_identifiable;
      result_.why = fmt::format(
          "a sample interval of {:.3g} ms cannot separate a reflex after {:g} to {:g} ms from the intrinsic response; "
          "at least {:g} Hz are needed",
          1e3 * T_, 1e3 * kEarliest, 1e3 * kLatest, 1.0 / kEarliest);
      return result_;
    }
    const Index coefficients = n_ * (2 * L_ + 1) + (n_ + 1) * (last_ - first_ + 1);
    rows_ = rows_inside(s_.identification, s_.pieces, last_, L_);
    const Index count = row_count(rows_);
    if (count < kRowsOfCascade * coefficients) {
      result_.found = DelayedResponse::not_identifiable;
      result_.why = fmt::format("a response of up to {:.2f} s has {} coefficients, too many for {} rows of {:.3g} ms",
                                kLongest, coefficients, count, 1e3 * T_);
      return result_;
    }
    Y_ = centred(rows_of(s_.resistance, rows_));
    for (Index j = 0; j < n_; ++j) {
      if (!(Y_.col(j).squaredNorm() > 0.0)) return bad_data("the force is constant; no response can be estimated");
      if (!(numeric::variance(s_.position.col(j)) > 0.0))
        return bad_data("the motion is constant; no response can be estimated");
    }
    fit_intrinsic();
    choose_direction();
    decide();
    if (result_.found == DelayedResponse::reflex) fit_reflex();
    judge();
    return result_;
  }

 private:
  [[nodiscard]] Both columns(const Both& of, Index first, Index last) const {
    Both both;
    both.measured = centred(lagged(of.measured, first, last, rows_));
    both.explained = result_.instruments ? centred(lagged(of.explained, first, last, rows_)) : both.measured;
    return both;
  }
  [[nodiscard]] Both velocity() const {
    return {s_.velocity, result_.instruments ? Matrix(s_.explained.middleCols(n_, n_)) : Matrix()};
  }
  [[nodiscard]] Both along(const Vector& direction) const {
    const Both v = velocity();
    return {v.measured * direction, result_.instruments ? Matrix(v.explained * direction) : Matrix()};
  }
  [[nodiscard]] Both rectified(const Vector& direction) const {
    const Both v = along(direction);
    return {v.measured.cwiseMax(0.0), v.explained.size() > 0 ? Matrix(v.explained.cwiseMax(0.0)) : Matrix()};
  }

  [[nodiscard]] Matrix intrinsic_position() const {
    return result_.instruments ? Matrix(s_.explained.leftCols(n_)) : s_.position;
  }

  /// The intrinsic path by itself.
  void fit_intrinsic() {
    const Both position{s_.position, result_.instruments ? Matrix(s_.explained.leftCols(n_)) : Matrix()};
    const Both X = columns(position, -L_, L_);
    const Matrix all = principal_directions(X.explained);
    const Matrix errors = cross_validated_errors(X.explained * all, Y_, 1, kFolds);
    Index best = 0;
    errors.colwise().mean().minCoeff(&best);
    directions_ = all.leftCols(best + 1);
    none_ = errors.col(best);
    result_.intrinsic_vaf = 100.0 * (1.0 - none_.mean());
    intrinsic_ = {X.measured * directions_, X.explained * directions_};
    alone_ = fit_lagged(intrinsic_.measured, intrinsic_.explained, Y_, rows_);
  }

  /// Cross-validated errors of the intrinsic path with lags first_ … first_ + k of a signal, k = 0, 1, …
  [[nodiscard]] Matrix errors_of(const Both& signal) const {
    const Matrix& u = result_.instruments ? signal.explained : signal.measured;
    const LaggedSignals motion{intrinsic_position(), -L_, L_}, delayed{u, first_, last_};
    const Index m = u.cols(), count = delayed.lags(), base = directions_.cols(), raw = motion.columns();
    auto moments = lagged_moments({motion, delayed}, s_.resistance, folds_of(rows_, kFolds));
    if (m > 1) {  // the signals lag by lag
      std::vector<Index> order;
      for (Index k = 0; k < raw; ++k) order.push_back(k);
      for (Index lag = 0; lag < count; ++lag) {
        for (Index k = 0; k < m; ++k) order.push_back(raw + k * count + lag);
      }
      moments = of_columns(moments, order);
    }
    const Matrix errors = cross_validated_errors(in_directions(moments, directions_), base);
    Matrix whole(errors.rows(), count);
    for (Index lag = 0; lag < count; ++lag) whole.col(lag) = errors.col((lag + 1) * m);
    return whole;
  }

  void choose_direction() {
    struct Tried {
      Vector direction, errors;
      Index last;
    };
    const auto tried = [&](const Vector& direction, const Both& signal) {
      const Matrix errors = errors_of(signal);
      Index best = 0;
      errors.colwise().mean().minCoeff(&best);
      return Tried{direction, errors.col(best), first_ + best};
    };
    std::vector<Tried> all;
    for (const Vector& direction : directions_of(n_)) all.push_back(tried(direction, rectified(direction)));
    const auto best = *std::ranges::min_element(
        all, [](const Tried& a, const Tried& b) { return a.errors.mean() < b.errors.mean(); });
    direction_ = best.direction;
    end_ = best.last;
    one_way_ = best.errors;
    to_and_fro_ =
        std::ranges::find_if(all, [&](const Tried& one) { return one.direction.dot(direction_) < -0.99; })->errors;
    all.push_back(tried({}, velocity()));
    both_ways_ = all.back().errors;
    std::ranges::sort(all, [](const Tried& a, const Tried& b) { return a.errors.mean() < b.errors.mean(); });
    for (const Tried& one : all) {
      const Vector excess = one.errors - best.errors;
      result_.candidates.push_back({one.direction, 100.0 * (1.0 - one.errors.mean()),
                                    100.0 * std::sqrt(numeric::variance(excess) / static_cast<double>(excess.size()))});
    }
  }

  /// p of |eᵀẋ| adding nothing to a delayed response that is linear.
  [[nodiscard]] double p_of_rectification() const {
    const auto grouped = [&](const Both& signal) {
      return summed_lags(columns(signal, first_, last_).explained, last_ - first_ + 1,
                         std::max<Index>(1, std::llround(kTestedLags / T_)));
    };
    const Both v = along(direction_);
    const Matrix linear = grouped(velocity());
    const Matrix unsigned_speed =
        grouped({v.measured.cwiseAbs(), v.explained.size() > 0 ? Matrix(v.explained.cwiseAbs()) : Matrix()});
    Matrix Z(Y_.rows(), intrinsic_.explained.cols() + linear.cols() + unsigned_speed.cols());
    Z << intrinsic_.explained, linear, unsigned_speed;
    const double chance = chance_of_no_part(Z, Z.cols() - unsigned_speed.cols(), Y_, rows_);
    const auto directions = static_cast<double>(directions_of(n_).size()) / 2.0;  // |v| is the same to and fro
    return std::min(1.0, chance * directions);
  }

  void decide() {
    result_.p_value = p_of_rectification();
    const double none = none_.mean(), one = one_way_.mean(), both = both_ways_.mean();
    const bool rectified_helps = predicts_better(one_way_, none_) && one < both && result_.p_value < kChanceOfReflex;
    const bool one_sided = predicts_better(one_way_, to_and_fro_) && one < (1.0 - kOneSided) * to_and_fro_.mean();
    if (rectified_helps && one_sided) {
      result_.found = DelayedResponse::reflex;
      result_.why = fmt::format(
          "stretch in one direction predicts {:.2f} % of the force, in both directions {:.2f} %, without a delayed "
          "response {:.2f} % (cross-validated); {} for equal responses in both directions",
          100.0 * (1.0 - one), 100.0 * (1.0 - both), 100.0 * (1.0 - none), chance_text(result_.p_value));
    } else if (rectified_helps) {
      result_.found = DelayedResponse::none;
      result_.why = fmt::format(
          "stretch in one direction predicts {:.2f} % of the force, in the opposite one {:.2f} %, without a delayed "
          "response {:.2f} % (cross-validated): the force is nearly the same in both directions, which indicates a "
          "nonlinear limb or posture, whereas a reflex responds to one direction only",
          100.0 * (1.0 - one), 100.0 * (1.0 - to_and_fro_.mean()), 100.0 * (1.0 - none));
    } else if (both < none && predicts_better(both_ways_, none_)) {
      result_.found = DelayedResponse::both_directions;
      result_.why = fmt::format(
          "a delayed response to motion in both directions predicts {:.2f} % of the force, to one direction only "
          "{:.2f} %, without it {:.2f} % (cross-validated); {} for equal responses in both directions",
          100.0 * (1.0 - both), 100.0 * (1.0 - one), 100.0 * (1.0 - none), chance_text(result_.p_value));
    } else {
      result_.found = DelayedResponse::none;
      result_.why = fmt::format(
          "a delayed response to stretch does not predict the force better than the limb alone ({:.2f} against {:.2f} "
          "%, cross-validated), or {} for equal responses in both directions is too large",
          100.0 * (1.0 - std::min(one, both)), 100.0 * (1.0 - none), chance_text(result_.p_value));
    }
  }

  /// First lag of the reflex, by BIC of whitened rows from which the earliest lags are dropped.
  void choose_delay(const Both& stretch) {
    const Both lags = columns(stretch, first_, end_);
    const Index count = lags.explained.cols(), base = intrinsic_.explained.cols();
    Matrix Z(Y_.rows(), base + count);
    Z << intrinsic_.explained, lags.explained.rowwise().reverse();
    const LaggedFit fit = fit_lagged(Z, Z, Y_, rows_);
    const Index tried = std::min(count, static_cast<Index>(std::llround(kLatest / T_)) - first_ + 1);
    Vector bic = Vector::Zero(tried), deviance = Vector::Zero(tried);
    for (Index j = 0; j < n_; ++j) {
      const Vector& noise = fit.noise[static_cast<std::size_t>(j)];
      const Matrix rows = whitened(Z, noise, rows_);
      const Vector squares = nested_squares(rows, whitened(Y_.col(j), noise, rows_));
      const auto N = static_cast<double>(rows.rows());
      for (Index drop = 0; drop < tried; ++drop) {
        const Index kept = base + count - drop;
        deviance[drop] += N * std::log(squares[kept] / N);
        bic[drop] += N * std::log(squares[kept] / N) + static_cast<double>(kept) * std::log(N);
      }
    }
    Index best = 0;
    bic.minCoeff(&best);
    Index low = best, high = best;
    constexpr double kConfidence = 0.975;  // at each end
    const auto limit = [&](Index lags_between) {
      return numeric::chi_square_quantile(kConfidence, static_cast<int>(n_ * lags_between));
    };
    for (Index drop = best + 1; drop < tried && deviance[drop] - deviance[best] < limit(drop - best); ++drop)
      high = drop;
    for (Index drop = best - 1; drop >= 0; --drop) {
      if (deviance[best] - deviance[drop] > limit(best - drop)) low = drop;
    }
    start_ = first_ + best;
    const auto seconds = [&](Index drop) { return T_ * static_cast<double>(first_ + drop); };
    result_.delay = seconds(best);
    result_.delay_low = seconds(low);
    result_.delay_high = seconds(high);
    result_.delay_at_limit = low == 0;
  }

  /// Both paths together, for one input of the reflex path.
  struct JointFit {
    Matrix directions;  ///< lags×r, of the reflex path
    LaggedFit fit;      ///< of the intrinsic directions, then those
    double vaf = 0;     ///< [%], in sample, mean over the axes
  };
  [[nodiscard]] JointFit fit_both(const Both& stretch) const {
    JointFit joint;
    const Both lags = columns(stretch, start_, end_);
    const Matrix all = principal_directions(lags.explained);
    const Index base = intrinsic_.explained.cols();
    Matrix R(Y_.rows(), base + all.cols());
    R << intrinsic_.explained, lags.explained * all;
    const Matrix errors = cross_validated_errors(R, Y_, base + 1, kFolds);
    Index best = 0;
    errors.colwise().mean().minCoeff(&best);
    joint.directions = all.leftCols(best + 1);
    Matrix Z(Y_.rows(), base + best + 1);
    Z << intrinsic_.measured, lags.measured * joint.directions;
    joint.fit = fit_lagged(Z, R.leftCols(Z.cols()), Y_, rows_);
    for (Index j = 0; j < n_; ++j) joint.vaf += numeric::variance_accounted_for(Y_.col(j), joint.fit.residual.col(j));
    joint.vaf /= static_cast<double>(n_);
    return joint;
  }

  [[nodiscard]] Both through(const Both& stretch, const Vector& polynomial) const {
    const auto value = [&](const Matrix& v) {
      Matrix sum = Matrix::Zero(v.rows(), v.cols());
      const Matrix scaled = v / result_.speed_scale;
      for (Index k = polynomial.size() - 1; k >= 0; --k)
        sum = ((sum.array() + polynomial[k]) * scaled.array()).matrix();
      return sum;
    };
    return {value(stretch.measured), stretch.explained.size() > 0 ? value(stretch.explained) : Matrix()};
  }

  /// What of columns the intrinsic path cannot make.
  [[nodiscard]] Matrix beyond_intrinsic(const Matrix& of) const {
    return of - intrinsic_.explained * numeric::householder_solve(intrinsic_.explained, of);
  }

  /// Powers of the stretch behind the reflex response, axes under each other, without what the intrinsic path explains.
  /// @param response lags×n
  [[nodiscard]] std::pair<Matrix, Vector> powers(const Both& stretch, const Matrix& response) const {
    const Index N = Y_.rows();
    Matrix W(N * n_, kMaxOrder);
    Vector y(N * n_);
    for (Index k = 0; k < kMaxOrder; ++k) {
      const Matrix lags = columns(through(stretch, Vector::Unit(kMaxOrder, k).head(k + 1)), start_, end_).explained;
      const Matrix answered = beyond_intrinsic(lags * response);
      for (Index j = 0; j < n_; ++j) W.col(k).segment(j * N, N) = answered.col(j) / deviation(j);
    }
    const Matrix left = beyond_intrinsic(Y_);
    for (Index j = 0; j < n_; ++j) y.segment(j * N, N) = left.col(j) / deviation(j);
    return {W, y};
  }
  [[nodiscard]] double deviation(Index axis) const { return std::sqrt(numeric::variance(Y_.col(axis))); }

  [[nodiscard]] Matrix response_of(const JointFit& joint) const {
    return joint.directions * joint.fit.coefficients.bottomRows(joint.directions.cols());
  }

  /// The polynomial whose mean slope, weighted by speed, is 1.
  [[nodiscard]] Vector normalised(const Vector& polynomial, const Both& stretch) const {
    const Vector v = rows_of(stretch.measured, rows_);
    const Vector value = rows_of(through(stretch, polynomial).measured, rows_);
    const double slope = v.dot(value) / v.squaredNorm();
    return polynomial / slope;
  }

  void fit_reflex() {
    const Both stretch = rectified(direction_);
    result_.direction = direction_;
    choose_delay(stretch);
    result_.speed_scale = rows_of(stretch.measured, rows_).maxCoeff();
    Vector polynomial = Vector::Constant(1, result_.speed_scale);  // N(v) = v
    JointFit joint = fit_both(through(stretch, polynomial));

    const auto [W, y] = powers(stretch, response_of(joint));
    const Matrix errors = cross_validated_errors(W, y, 1, kFolds);
    Index best = 0, order = 1;
    errors.colwise().mean().minCoeff(&best);
    for (Index k = 0; k <= best; ++k) {
      const Vector excess = errors.col(k) - errors.col(best);
      if (excess.mean() <= std::sqrt(numeric::variance(excess) / static_cast<double>(excess.size()))) {
        order = k + 1;
        break;
      }
    }
    if (order > 1) {
      for (int swap = 0; swap < kMaxSwaps; ++swap) {
        const auto [powers_now, left] = powers(stretch, response_of(joint));
        const Vector next =
            normalised(numeric::householder_solve(powers_now.leftCols(order), Matrix(left)).col(0), stretch);
        if (!next.allFinite()) break;
        JointFit better = fit_both(through(stretch, next));
        const double gain = better.vaf - joint.vaf;
        if (gain <= 0.0) break;
        joint = std::move(better);
        polynomial = next;
        if (gain < kSwapTolerance) break;
      }
    }
    result_.nonlinearity = polynomial;

    const Index base = intrinsic_.explained.cols(), r = joint.directions.cols(), lags = joint.directions.rows();
    result_.memory = T_ * static_cast<double>(end_);
    result_.reflex_lag = Vector::LinSpaced(lags, result_.delay, result_.memory);
    result_.reflex_rank = r;
    reflex_ = response_of(joint);
    result_.reflex = reflex_ / T_;
    result_.reflex_half_width.resize(lags, n_);
    for (Index j = 0; j < n_; ++j) {
      const Matrix C = joint.fit.covariance[static_cast<std::size_t>(j)].bottomRightCorner(r, r);
      result_.reflex_half_width.col(j) =
          numeric::kNormal95 *
          (joint.directions * C).cwiseProduct(joint.directions).rowwise().sum().cwiseMax(0.0).cwiseSqrt() / T_;
    }
    describe(through(stretch, polynomial));
    stretch_ = through(stretch, polynomial);
    reflex_directions_ = joint.directions;
    joint_ = std::move(joint.fit);
    joint_->coefficients.conservativeResize(base, Eigen::NoChange);
    for (Matrix& C : joint_->covariance) C = C.topLeftCorner(base, base).eval();
  }

  /// Gain, second-order response and intrinsic M, B and K from a fit with all lags, none of them chosen: where lags or
  /// directions are left out because they predict little, their sum is biased.
  void describe(const Both& stretch) {
    const Both lags = columns(stretch, first_, last_);
    const Matrix directions = principal_directions(lags.explained);
    const Index base = intrinsic_.explained.cols(), r = directions.cols(), count = directions.rows();
    Matrix Z(Y_.rows(), base + r), R(Y_.rows(), base + r);
    Z << intrinsic_.measured, lags.measured * directions;
    R << intrinsic_.explained, lags.explained * directions;
    const LaggedFit fit = fit_lagged(Z, R, Y_, rows_);

    const Vector sum = directions.colwise().sum().transpose();
    result_.gain_along = {};
    double variance_along = 0.0;
    std::vector<Matrix> covariances;
    const Matrix coefficients = fit.coefficients.bottomRows(r);
    for (Index j = 0; j < n_; ++j) {
      covariances.push_back(fit.covariance[static_cast<std::size_t>(j)].bottomRightCorner(r, r));
      const double variance = std::max(0.0, sum.dot(covariances.back() * sum));
      const double value = sum.dot(coefficients.col(j));
      result_.gain.push_back({value, numeric::kNormal95 * std::sqrt(variance)});
      result_.gain_along.value += direction_[j] * value;
      variance_along += direction_[j] * direction_[j] * variance;
    }
    result_.gain_along.half_width = numeric::kNormal95 * std::sqrt(variance_along);
    constexpr double kCarried = 0.5;  // share of a steady stretch that the directions hold
    result_.gain_identifiable = sum.squaredNorm() >= kCarried * static_cast<double>(count) &&
                                result_.gain_along.half_width < std::abs(result_.gain_along.value);
    const auto freedom = static_cast<double>(Y_.rows() - Z.cols());
    result_.second_order = fit_second_order(directions, coefficients, covariances, T_, first_, freedom);

    Matrix derivatives(s_.position.rows(), 3 * n_);
    derivatives << s_.acceleration, s_.velocity, s_.position;
    const Matrix D =
        numeric::Lu(numeric::products_of(R, Z)).solve(numeric::products_of(R, centred(rows_of(derivatives, rows_))));
    result_.intrinsic_model = fit_response_model(D.topRows(base), fit, n_);
  }

  void judge() {
    const LaggedFit& fit = joint_ ? *joint_ : alone_;
    const Index lags = 2 * L_ + 1;
    result_.intrinsic_lag = Vector::LinSpaced(lags, -T_ * static_cast<double>(L_), T_ * static_cast<double>(L_));
    result_.intrinsic.resize(lags, n_ * n_);
    result_.intrinsic_half_width.resize(lags, n_ * n_);
    for (Index j = 0; j < n_; ++j) {
      const Matrix part = directions_.middleRows(j * lags, lags);
      for (Index i = 0; i < n_; ++i) {
        result_.intrinsic.col(i + j * n_) = part * fit.coefficients.col(i) / T_;
        result_.intrinsic_half_width.col(i + j * n_) = numeric::kNormal95 *
                                                       (part * fit.covariance[static_cast<std::size_t>(i)])
                                                           .cwiseProduct(part)
                                                           .rowwise()
                                                           .sum()
                                                           .cwiseMax(0.0)
                                                           .cwiseSqrt() /
                                                       T_;
      }
    }
    const auto rows = rows_inside(result_.held_out ? s_.validation : s_.identification, s_.pieces, last_, L_);
    if (s_.muscles.cols() > 0) result_.emg = emg_path_on(rows);
    if (row_count(rows) < 2) return;
    const Matrix force = rows_of(s_.resistance, rows), motion = lagged(s_.position, -L_, L_, rows);
    const Matrix alone = motion * (directions_ * alone_.coefficients);
    const Matrix intrinsic = motion * (directions_ * fit.coefficients);
    const Matrix reflex =
        joint_ ? Matrix(lagged(stretch_.measured, start_, end_, rows) * reflex_) : Matrix::Zero(force.rows(), n_);
    for (Index j = 0; j < n_; ++j) {
      const auto judged = [&](const Vector& predicted) {
        const AccountedFor one = accounted_for(force.col(j), force.col(j) - predicted, rows, T_);
        return ExplainedForce{one.percent, one.half_width, one.rmse};
      };
      PathShares shares;
      shares.intrinsic_alone = judged(alone.col(j));
      shares.both = judged(intrinsic.col(j) + reflex.col(j));
      shares.intrinsic_path = judged(intrinsic.col(j));
      shares.reflex_path = judged(reflex.col(j));
      result_.shares.push_back(shares);
    }
  }

  [[nodiscard]] EmgPath emg_path_on(const std::vector<RowRange>& judged) const {
    const PathColumns intrinsic{intrinsic_.measured, intrinsic_.explained,
                                lagged(s_.position, -L_, L_, judged) * directions_};
    PathColumns reflex{Matrix(Y_.rows(), 0), Matrix(Y_.rows(), 0), Matrix(row_count(judged), 0)};
    if (joint_) {
      const Both lags = columns(stretch_, start_, end_);
      reflex = {lags.measured * reflex_directions_, lags.explained * reflex_directions_,
                lagged(stretch_.measured, start_, end_, judged) * reflex_directions_};
    }
    return emg_path(s_, rows_, judged, intrinsic, reflex);
  }

  const LimbSignals& s_;
  Index n_;
  double T_;
  Index L_, first_, last_;     ///< lags [rows]: of the intrinsic path, earliest and latest of the reflex path
  Index start_ = 0, end_ = 0;  ///< of the reflex path, as chosen
  std::vector<RowRange> rows_;
  Matrix Y_;
  Matrix directions_;  ///< of the intrinsic path
  Both intrinsic_;     ///< rows×r
  LaggedFit alone_;
  std::optional<LaggedFit> joint_;  ///< its intrinsic part
  Vector direction_;
  Vector none_, one_way_, to_and_fro_, both_ways_;  ///< errors fold by fold; to_and_fro_: the opposite direction
  Matrix reflex_, reflex_directions_;               ///< g T; lags×r
  Both stretch_;                                    ///< N(v⁺)
  ParallelCascadeEstimate result_;
};

}  // namespace

Result<ParallelCascadeEstimate> parallel_cascade(const LimbSignals& signals) {
  return Cascade(signals).run();
}

}  // namespace mbk::explore
