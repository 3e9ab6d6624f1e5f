#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/recording.h"

namespace mbk {

/// An interval of more than 1.5 times the median one. Where the clock jitters by more than 2 %: of more than 1.2 times,
/// and all later stamps are shifted by half an interval or more, as after a lost sample.
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

/// Consecutive samples that are NaN in every channel: losses of a session.
struct MissingSamples {
  Index first = 0;  ///< sample
  Index count = 0;
  double time = 0.0;  ///< of the first [s]
};

struct ChannelFacts {
  std::string name;
  std::string unit;
  double min = 0.0;  ///< of the finite values; NaN if there is none
  double max = 0.0;
  bool constant = false;          ///< one value throughout
  bool clipped = false;           ///< a force, reaction, acceleration or torque that saturates at its extremes
  double clipped_fraction = 0.0;  ///< of the samples: those in long runs at the extremes
  double update_hz = 0.0;         ///< its update rate; NaN if the recording has no rate
  Updates updates = {};           ///< type of repetition, if it was not measured at every sample
  std::string stale;              ///< the same as a sentence; "" if every sample is a measurement
};

/// Facts about a recording, without judgement or repair. Intervals that are not positive or not finite are counted as
/// duplicated, backward or non-finite time and excluded from the interval statistics.
struct Inspection {
  Index samples = 0;
  double duration = 0.0;  ///< last time − first time [s]
  double rate_hz = 0.0;   ///< 1 / mean interval if time has no gap, otherwise 1 / median; NaN: < 2 samples

  double interval_min = 0.0;  ///< [s]; all four are NaN if no interval is positive
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
