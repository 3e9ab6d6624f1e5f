#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/recording.h"

namespace mbk {

/// An interval of more than 1.5 times the median one. Where the clock jitters by more than 2 %: of more than 1.2 times,
/// and all stamps behind it stay later by half an interval or more, as behind a lost sample.
struct Gap {
  Index sample = 0;     ///< the last sample before it
  double time = 0.0;    ///< of that sample [s]
  double length = 0.0;  ///< to the next sample [s]
};

/// Values of a channel (or of "time") that are NaN or infinite.
struct NonFinite {
  std::string channel;
  Index count = 0;
  Index first = 0;  ///< sample
};

/// Samples that follow each other and are NaN in every channel: what a session lost.
struct MissingSamples {
  Index first = 0;  ///< sample
  Index count = 0;
  double time = 0.0;  ///< of the first [s]
};

struct ChannelFacts {
  std::string name;
  std::string unit;
  double min = 0.0;  ///< of the finite values; NaN where there is none
  double max = 0.0;
  bool constant = false;          ///< one value throughout
  bool clipped = false;           ///< a force, reaction, acceleration or torque that rests at its extremes
  double clipped_fraction = 0.0;  ///< of the samples: those in long runs at the extremes
  double update_hz = 0.0;         ///< how often it was measured; NaN where the recording has no rate
  Updates updates = {};           ///< how, where that is not once a sample
  std::string stale;              ///< the same as a sentence; "" where every sample is a measurement
};

/// Facts about a recording; nothing is judged or repaired. Intervals that are not positive or not finite count as
/// duplicated, backward or non-finite time and stay out of the interval statistics.
struct Inspection {
  Index samples = 0;
  double duration = 0.0;  ///< last time − first time [s]
  double rate_hz = 0.0;   ///< 1 / mean interval where time runs on without a gap, else 1 / median; NaN: < 2 samples

  double interval_min = 0.0;  ///< [s]; the four are NaN where no interval is positive
  double interval_median = 0.0;
  double interval_max = 0.0;
  double interval_standard_deviation = 0.0;

  std::vector<Gap> gaps;
  Index duplicated_times = 0;
  Index first_duplicated = -1;  ///< sample whose time equals the one before; −1: none
  Index backward_times = 0;
  Index first_backward = -1;  ///< sample whose time is before the one before; −1: none
  std::vector<NonFinite> non_finite;
  std::vector<MissingSamples> missing;
  std::vector<ChannelFacts> channels;
};

}  // namespace mbk
