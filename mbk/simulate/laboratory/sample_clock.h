#pragma once

#include <algorithm>

#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// The clock of the control loop. Tick k comes at t₀ + k T + d[k], late or early by d[k] of its own, so that
///   interval[k] = T + d[k+1] − d[k],  d = σ/√2 · n[k] within ±0.45 T,  d[0] = 0
/// The intervals' standard deviation is σ, time always goes on (by 0.1 T at least), and errors do not add up.
class SampleClock {
 public:
  /// @param jitter  σ ≥ 0 [s]; 0 gives T each time    @param sample_time  T > 0 [s]
  SampleClock(double jitter, double sample_time, numeric::Random random)
      : sample_time_(sample_time), lateness_(jitter * kPerTick, random) {}

  /// [s]
  double next_interval() noexcept {
    const double last = late_;
    late_ = std::clamp(lateness_.next(), -0.45 * sample_time_, 0.45 * sample_time_);
    return sample_time_ + (late_ - last);
  }

 private:
  static constexpr double kPerTick = 0.70710678118654752;  // √½: an interval has two ends
  double sample_time_, late_ = 0.0;
  WhiteNoise lateness_;
};

}  // namespace mbk::laboratory
