#pragma once

#include <utility>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"

namespace mbk::preprocess {

/// Sample numbers and seconds of a recording, both counted from its first sample. Behind a gap or a jump of the clock
/// they part: the seconds are those that were recorded.
class Clock {
 public:
  /// @param time as recorded [s], at least one sample    @param rate nominal sample rate, > 0
  /// The time must not be gone before the clock.
  Clock(const Vector& time, Hertz rate) : time_(time.data()), samples_(time.size()), rate_(rate) {}
  Clock(Vector&& time, Hertz rate) : own_(std::move(time)), time_(own_.data()), samples_(own_.size()), rate_(rate) {}
  Clock(Clock&&) = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  Clock& operator=(Clock&&) = delete;
  ~Clock() = default;

  [[nodiscard]] Index samples() const { return samples_; }
  [[nodiscard]] Hertz rate() const { return rate_; }

  /// When a sample was taken [s]; beyond the last one time goes on at the rate.
  [[nodiscard]] double seconds(Index sample) const {
    if (sample < samples()) return time_[sample] - time_[0];
    return time_[samples() - 1] - time_[0] + static_cast<double>(sample - samples() + 1) / rate_.value;
  }

  /// How long the recording lasts [s], the last interval included.
  [[nodiscard]] double duration() const { return seconds(samples()); }

  /// The first sample that was not taken more than half an interval before; `samples()` or more where there is none.
  /// @param seconds finite, in [0, duration + a few intervals]
  [[nodiscard]] Index sample(double seconds) const;

 private:
  Vector own_;          ///< empty where the time stands elsewhere
  const double* time_;  ///< [s], as recorded
  Index samples_;
  Hertz rate_;
};

}  // namespace mbk::preprocess
