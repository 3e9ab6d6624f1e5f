#pragma once

#include <string>
#include <vector>

#include "mbk/core/linear_algebra.h"

namespace mbk {

/// An interval of more than 1.5 × the median one.
struct Gap {
  Index sample = 0;   ///< the gap is between this sample and the next
  double time = 0;    ///< [s] of that sample
  double length = 0;  ///< [s]
};

/// What one channel holds.
struct ChannelFacts {
  std::string name, unit;
  double minimum = 0, maximum = 0;  ///< of the finite values
  Index non_finite = 0;             ///< NaN or ∞
  Index first_non_finite = -1;
  bool constant = false;  ///< all finite values are equal
  bool clipped = false;   ///< force, acceleration or torque that rests exactly at its extreme, repeatedly
};

/// Facts about a recording; nothing is repaired.
struct Inspection {
  Index samples = 0;
  double duration = 0;  ///< [s] last minus first time
  double rate_hz = 0;   ///< 1/median interval; 0 where there are fewer than two samples
  double interval_minimum = 0, interval_median = 0, interval_maximum = 0;  ///< [s]
  double interval_deviation = 0;                                           ///< standard deviation [s]
  std::vector<Gap> gaps;
  Index duplicated_times = 0, first_duplicated = -1;  ///< sample that has the time of the one before it
  Index backward_times = 0, first_backward = -1;      ///< sample that is earlier than the one before it
  Index non_finite_times = 0, first_non_finite_time = -1;
  std::vector<ChannelFacts> channels;
};

}  // namespace mbk
