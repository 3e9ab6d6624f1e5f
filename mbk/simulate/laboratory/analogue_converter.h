#pragma once

#include <algorithm>
#include <cmath>

#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// A converter of n bits and ±range: the nearest of the codes −2^(n−1) … 2^(n−1) − 1, of 2·range/2ⁿ [V] each.
class AnalogueConverter {
 public:
  /// @param bits  0: no converter    @param range  > 0 [V]
  AnalogueConverter(int bits, double range)
      : step_(bits == 0 ? 0.0 : std::ldexp(range, 1 - bits)), lowest_(-range), highest_(range - step_) {}

  struct Conversion {
    double voltage;  ///< [V]
    bool clipped;    ///< the voltage was outside the range of the codes
  };

  [[nodiscard]] Conversion convert(double voltage) const noexcept {
    if (step_ == 0.0) return {voltage, false};
    const double rounded = quantised(voltage, step_);
    return {std::clamp(rounded, lowest_, highest_), rounded < lowest_ || rounded > highest_};
  }

  /// Of one code [V]; 0 without a converter.
  [[nodiscard]] double step() const { return step_; }

 private:
  double step_, lowest_, highest_;
};

}  // namespace mbk::laboratory
