#include "mbk/measure/preprocess/force_delay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/measure/preprocess/straight_lines.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {
namespace {

bool is_force(const Channel& channel) {
  return channel.name == kForceChannels.one_axis || std::ranges::count(kForceChannels.several, channel.name) > 0;
}

}  // namespace

Result<Recording> undo_force_delay(const Recording& recording, double delay) {
  const Vector& time = recording.time;
  const Index samples = recording.samples();
  if (!std::isfinite(delay)) return bad_usage("a delay of the force must be finite");
  if (std::ranges::none_of(recording.channels, is_force)) return bad_data("no force was recorded");
  if (samples < 2 || !((time.tail(samples - 1) - time.head(samples - 1)).minCoeff() > 0.0)) {
    return bad_data("time does not increase, so a delay cannot be corrected", "resample with --resample HZ");
  }
  Index begin = 0, end = samples;
  while (begin < samples && time[begin] + delay < time[0]) ++begin;
  while (end > begin && time[end - 1] + delay > time[samples - 1]) --end;
  if (end - begin < 2) {
    return bad_usage(fmt::format("a delay of {:g} s is as long as the recording", delay), "give the delay in ms");
  }
  Recording result = recording;
  result.time = time.segment(begin, end - begin);
  for (Channel& channel : result.channels) {
    const Vector values = channel.values;
    channel.values = values.segment(begin, end - begin);
    if (!is_force(channel)) continue;
    StraightLines between(time);
    for (Index i = begin; i < end; ++i) {
      between.move_to(time[i] + delay);
      channel.values[i - begin] = between.value_of(values);
    }
  }
  return result;
}

}  // namespace mbk::preprocess
