#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"

namespace mbk::preprocess {

/// Sample numbers and seconds of a recording, both counted from its first sample. Behind a gap or a jump of the clock
/// they part: the seconds are those that were recorded.
class Clock {
 public:
  /// @param time as recorded [s], at least one sample    @param rate nominal sample rate, > 0
  Clock(const Vector& time, Hertz rate) : seconds_(time.array() - time[0]), rate_(rate) {}

  [[nodiscard]] Index samples() const { return seconds_.size(); }
  [[nodiscard]] Hertz rate() const { return rate_; }

  /// When a sample was taken [s]; beyond the last one time goes on at the rate.
  [[nodiscard]] double seconds(Index sample) const;

  /// How long the recording lasts [s], the last interval included.
  [[nodiscard]] double duration() const { return seconds(samples()); }

  /// The first sample that was not taken more than half an interval before; `samples()` or more where there is none.
  /// @param seconds finite, in [0, duration + a few intervals]
  [[nodiscard]] Index sample(double seconds) const;

 private:
  Vector seconds_;
  Hertz rate_;
};

}  // namespace mbk::preprocess
