#pragma once

#include <span>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"

namespace mbk::explore {

/// One reach as it was recorded, with the row at which the hand is displaced, or would be: the same event of every
/// reach, such as the hand's passing a place.
struct RecordedReach {
  Matrix position;             ///< N×n, base frame [m]
  Matrix force_hand_on_robot;  ///< N×n [N]; empty where it is not needed
  Index trigger = 0;           ///< row
};

struct ReachPredictionOptions {
  double past = 0.2;       ///< of the reach that is looked at, up to the trigger [s]
  double future = 0.3;     ///< that is predicted, from the trigger [s]
  double step = 0.02;      ///< between the samples of the past that are looked at [s]
  int max_components = 6;  ///< of the past, at most; 0: the mean of the undisturbed reaches, whatever the past
};

/// What a reach would have done had it not been disturbed, from its own past: deviations of the future from that of the
/// mean undisturbed reach are regressed on the r principal components of the deviations of the past,
///   ŷ(t) = x(0) + ȳ(t) + W(t) V_rᵀ (p − p̄),
/// with p the places of the past and y those of the future, both from the place at the trigger x(0), and forces as they
/// are. r is the number, up to max_components, that predicts left-out undisturbed reaches best.
class ReachPrediction {
 public:
  /// @param undisturbed  as many as 8 and more    @param sample_time  T [s]
  /// @fails  usage: an option is not above 0. data: too few reaches; one that does not hold the past and the future of
  /// its trigger; reaches of different axes; a value is not finite.
  [[nodiscard]] static Result<ReachPrediction> create(std::span<const RecordedReach> undisturbed, double sample_time,
                                                      const ReachPredictionOptions& options = {});

  struct Predicted {
    Matrix position;             ///< rows from the trigger on, n columns [m]
    Matrix force_hand_on_robot;  ///< likewise [N]; empty where the undisturbed reaches have none
  };
  /// @fails  data: the reach does not hold the past of its trigger, or has other axes.
  [[nodiscard]] Result<Predicted> predict(const RecordedReach& reach) const;

  [[nodiscard]] int components() const { return static_cast<int>(directions_.cols()); }
  [[nodiscard]] Index future_rows() const { return future_; }
  /// Root mean square of the distance between the predicted and the true place of left-out undisturbed reaches, at each
  /// row of the future [m].
  [[nodiscard]] const Vector& left_out_error() const { return left_out_error_; }

 private:
  [[nodiscard]] Result<Vector> past_of(const RecordedReach& reach) const;
  [[nodiscard]] Vector future_of(const RecordedReach& reach) const;

  Index axes_ = 0, future_ = 0, step_ = 1, lags_ = 0;
  bool with_force_ = false;
  Vector mean_past_, mean_future_;
  Matrix directions_, weights_;  ///< V_r; W
  Vector left_out_error_;
};

}  // namespace mbk::explore
