#include "mbk/measure/preprocess/resample.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "mbk/measure/preprocess/straight_lines.h"
#include "mbk/measure/preprocess/windows.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

/// A reference that is constant but for some steps: between two samples it is what was commanded last.
bool is_held(const Channel& channel) {
  for (const int axes : {1, 3}) {
    for (Index axis = 0; axis < axes; ++axis) {
      if (channel.name == kReferenceChannels.name(axes, axis))
        return detect_protocol(channel.values).protocol == Protocol::underdamped;
    }
  }
  return false;
}

}  // namespace

Result<Recording> resample(const Recording& recording, Hertz rate) {
  const Index n = recording.samples();
  if (!(rate.value > 0.0 && rate.value <= 1e6))
    return bad_usage(fmt::format("--resample {:g} is not a rate in Hz", rate.value));
  if (n < 2) return bad_data("a recording of fewer than 2 samples cannot be resampled");
  for (Index i = 1; i < n; ++i) {
    if (!(recording.time[i] > recording.time[i - 1])) {
      return bad_data(
          fmt::format("time {} at sample {} ({:.6f} s after {:.6f} s), and only increasing time can be resampled",
                      recording.time[i] == recording.time[i - 1]  ? "repeats"
                      : recording.time[i] < recording.time[i - 1] ? "runs backwards"
                                                                  : "is not a number",
                      i + 1, recording.time[i], recording.time[i - 1]),
          "correct the time");
    }
  }
  const double first = recording.time[0];
  const double span = (recording.time[n - 1] - first) * rate.value;
  constexpr double kMax = 100.0;  // times as many samples: more is a mistake in the unit of time or rate
  if (!(span <= kMax * static_cast<double>(n))) {
    return bad_usage(fmt::format("--resample {:g} Hz would give {:.3g} samples from {}", rate.value, span, n),
                     "give a rate in Hz near that of the recording");
  }
  const auto count = static_cast<Index>(std::floor(span * (1.0 + 1e-12))) + 1;

  Recording even = recording;
  even.time.resize(count);
  for (Channel& channel : even.channels) channel.values.resize(count);
  std::vector<bool> held;
  for (const Channel& channel : recording.channels) held.push_back(is_held(channel));
  StraightLines between(recording.time);
  for (Index i = 0; i < count; ++i) {
    const double t = first + static_cast<double>(i) / rate.value;
    between.move_to(t);
    even.time[i] = t;
    for (std::size_t c = 0; c < even.channels.size(); ++c) {
      const Vector& recorded = recording.channels[c].values;
      even.channels[c].values[i] = held[c] ? between.held_value_of(recorded) : between.value_of(recorded);
    }
  }
  return even;
}

}  // namespace mbk::preprocess
