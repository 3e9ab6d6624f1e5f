#pragma once

#include "mbk/base/core/linear_algebra.h"

namespace mbk::preprocess {

/// Finds later and later instants between the samples of a clock, to read signals there by straight lines.
class StraightLines {
 public:
  /// @param time  [s], N ≥ 2, strictly increasing; it must outlive this
  explicit StraightLines(const Vector& time) : time_(time) {}

  /// @param when  [s], not before the instant that was asked for last
  void move_to(double when) {
    while (left_ + 2 < time_.size() && time_[left_ + 1] <= when) ++left_;
    weight_ = (when - time_[left_]) / (time_[left_ + 1] - time_[left_]);
  }

  /// A signal that is the same at both samples is exactly that between them.
  [[nodiscard]] double value_of(const Vector& signal) const {
    return weight_ == 0.0 ? signal[left_] : signal[left_] + weight_ * (signal[left_ + 1] - signal[left_]);
  }

  /// Of a signal that keeps its value until the next sample.
  [[nodiscard]] double held_value_of(const Vector& signal) const { return signal[weight_ < 1.0 ? left_ : left_ + 1]; }

 private:
  const Vector& time_;
  Index left_ = 0;
  double weight_ = 0.0;
};

}  // namespace mbk::preprocess
