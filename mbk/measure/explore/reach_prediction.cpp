#include "mbk/measure/explore/reach_prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/dense.h"

namespace mbk::explore {
namespace {

constexpr Index kMinReaches = 8;

/// Pasts and futures of reaches as rows, fitted without one of them, or with all.
struct PastAndFuture {
  Matrix past, future;

  struct Fit {
    Vector mean_past, mean_future;
    Matrix directions, weights;  ///< V, all components; weights of the future, a column for each
  };
  [[nodiscard]] Fit fit(Index left_out, Index components) const {
    const Index n = past.rows() - (left_out >= 0 ? 1 : 0);
    Matrix P(n, past.cols()), Y(n, future.cols());
    for (Index i = 0, row = 0; i < past.rows(); ++i) {
      if (i == left_out) continue;
      P.row(row) = past.row(i);
      Y.row(row++) = future.row(i);
    }
    Fit made;
    made.mean_past = P.colwise().mean().transpose();
    made.mean_future = Y.colwise().mean().transpose();
    P.rowwise() -= made.mean_past.transpose();
    Y.rowwise() -= made.mean_future.transpose();
    const numeric::ThinSvd svd = numeric::thin_svd(P);
    const Vector& size = svd.values;
    Index kept = 0;
    while (kept < std::min<Index>(components, size.size()) && size[kept] > 1e-9 * size[0]) ++kept;
    made.directions = svd.V.leftCols(kept);
    made.weights = Y.transpose() * svd.U.leftCols(kept);
    for (Index k = 0; k < kept; ++k) made.weights.col(k) /= size[k];
    return made;
  }
};

}  // namespace

Result<Vector> ReachPrediction::past_of(const RecordedReach& reach) const {
  if (reach.position.cols() != axes_) return bad_data("reaches of different axes");
  if (reach.trigger < step_ * lags_ || reach.trigger >= reach.position.rows()) {
    return bad_data(
        fmt::format("a reach has {} samples before its trigger, but {} are needed", reach.trigger, step_ * lags_),
        "use less of the past, or trigger later");
  }
  Vector past(lags_ * axes_);
  for (Index k = 0; k < lags_; ++k) {
    past.segment(k * axes_, axes_) =
        (reach.position.row(reach.trigger - (k + 1) * step_) - reach.position.row(reach.trigger)).transpose();
  }
  if (!past.allFinite()) return bad_data("a position of a reach is not finite");
  return past;
}

Vector ReachPrediction::future_of(const RecordedReach& reach) const {
  Vector future(future_ * axes_ * (with_force_ ? 2 : 1));
  for (Index i = 0; i < future_; ++i) {
    future.segment(i * axes_, axes_) =
        (reach.position.row(reach.trigger + i) - reach.position.row(reach.trigger)).transpose();
    if (with_force_) {
      future.segment((future_ + i) * axes_, axes_) = reach.force_hand_on_robot.row(reach.trigger + i).transpose();
    }
  }
  return future;
}

Result<ReachPrediction> ReachPrediction::create(std::span<const RecordedReach> undisturbed, double sample_time,
                                                const ReachPredictionOptions& options) {
  if (!(sample_time > 0.0 && options.past > 0.0 && options.future > 0.0 && options.step >= sample_time &&
        options.max_components >= 0)) {
    return bad_usage("past, future and step of a prediction are not above 0");
  }
  const auto n = static_cast<Index>(undisturbed.size());
  if (n < kMinReaches) {
    return bad_data(fmt::format("{} undisturbed reaches are fewer than {}", n, kMinReaches), "record more of them");
  }
  ReachPrediction made;
  made.axes_ = undisturbed.front().position.cols();
  made.future_ = static_cast<Index>(std::llround(options.future / sample_time));
  made.step_ = static_cast<Index>(std::llround(options.step / sample_time));
  made.lags_ = std::max<Index>(1, static_cast<Index>(std::llround(options.past / options.step)));
  made.with_force_ = undisturbed.front().force_hand_on_robot.size() > 0;
  PastAndFuture data{Matrix(n, made.lags_ * made.axes_), {}};
  for (Index i = 0; i < n; ++i) {
    const RecordedReach& reach = undisturbed[static_cast<std::size_t>(i)];
    auto past = MBK_TRY(made.past_of(reach));
    if (reach.trigger + made.future_ > reach.position.rows()) {
      return bad_data(fmt::format("an undisturbed reach ends {} samples after its trigger, but {} are needed",
                                  reach.position.rows() - reach.trigger, made.future_),
                      "record longer");
    }
    if (made.with_force_ != (reach.force_hand_on_robot.rows() == reach.position.rows()) ||
        (made.with_force_ && reach.force_hand_on_robot.cols() != made.axes_)) {
      return bad_data("a reach has different numbers of forces and positions");
    }
    const Vector future = made.future_of(reach);
    if (!future.allFinite()) return bad_data("a position or force of a reach is not finite");
    if (data.future.size() == 0) data.future.resize(n, future.size());
    data.past.row(i) = past.transpose();
    data.future.row(i) = future.transpose();
  }

  // Components nest, so one decomposition without each reach predicts it with every number of them.
  const Index most = std::min<Index>(options.max_components, n - 4), places = made.future_ * made.axes_;
  Matrix squares = Matrix::Zero(made.future_, most + 1);
  for (Index left_out = 0; left_out < n; ++left_out) {
    const PastAndFuture::Fit fit = data.fit(left_out, most);
    Vector error = (data.future.row(left_out).transpose() - fit.mean_future).head(places);
    const Vector scores = fit.directions.transpose() * (data.past.row(left_out).transpose() - fit.mean_past);
    for (Index r = 0; r <= most; ++r) {
      if (r > 0 && r <= scores.size()) error -= scores[r - 1] * fit.weights.col(r - 1).head(places);
      squares.col(r) += error.reshaped(made.axes_, made.future_).colwise().squaredNorm().transpose();
    }
  }
  Index best = 0;
  squares.colwise().sum().minCoeff(&best);
  PastAndFuture::Fit fit = data.fit(-1, best);
  made.mean_past_ = std::move(fit.mean_past);
  made.mean_future_ = std::move(fit.mean_future);
  made.directions_ = std::move(fit.directions);
  made.weights_ = std::move(fit.weights);
  made.left_out_error_ = (squares.col(best) / static_cast<double>(n)).cwiseSqrt();
  return made;
}

Result<ReachPrediction::Predicted> ReachPrediction::predict(const RecordedReach& reach) const {
  const auto past = MBK_TRY(past_of(reach));
  const Vector future = mean_future_ + weights_ * (directions_.transpose() * (past - mean_past_));
  Predicted predicted;
  const auto rows_of = [&](Index first) -> Matrix {
    return future.segment(first * axes_, future_ * axes_).reshaped(axes_, future_).transpose();
  };
  predicted.position = rows_of(0).rowwise() + reach.position.row(reach.trigger);
  if (with_force_) predicted.force_hand_on_robot = rows_of(future_);
  return predicted;
}

}  // namespace mbk::explore
