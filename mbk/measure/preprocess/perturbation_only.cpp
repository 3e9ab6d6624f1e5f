#include "mbk/measure/preprocess/perturbation_only.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mbk/measure/preprocess/exclusions.h"

namespace mbk::preprocess {

namespace {

/// Text that cannot be read stays, for whoever reads it next to say so.
void move_excluded_windows(double by, Recording& recording) {
  auto windows = excluded_windows(recording);
  if (!windows || windows->empty()) return;
  for (ExcludedWindow& one : *windows) {
    one.from_s = std::max(0.0, one.from_s + by);
    one.to_s += by;
  }
  std::erase_if(*windows, [](const ExcludedWindow& one) { return one.to_s <= one.from_s; });
  recording.metadata[kExcludedWindows] = excluded_windows_text(*windows);
}

}  // namespace

Recording perturbation_only(Recording recording) {
  const auto start = std::ranges::find(recording.events, "perturbation_start", &Event::name);
  if (start == recording.events.end()) return recording;
  const auto end =
      std::find_if(start, recording.events.end(), [](const Event& event) { return event.name == "perturbation_end"; });
  const double from = start->time,
               to = end == recording.events.end() ? std::numeric_limits<double>::infinity() : end->time;
  const double* const times = recording.time.data();
  const Index samples = recording.samples();
  const Index first = std::lower_bound(times, times + samples, from) - times,
              last = std::lower_bound(times, times + samples, to) - times;
  if (first >= last) return recording;
  recording.notes.push_back(fmt::format("only the perturbation is analysed: {:.3f} s to {:.3f} s of {:.3f} s", from,
                                        recording.time[last - 1], recording.time[samples - 1]));
  move_excluded_windows(-from, recording);
  recording.time = Vector(recording.time.segment(first, last - first).array() - from);
  for (Channel& channel : recording.channels) channel.values = Vector(channel.values.segment(first, last - first));
  std::erase_if(recording.events, [&](const Event& event) { return event.time < from || event.time > to; });
  for (Event& event : recording.events) event.time -= from;
  return recording;
}

}  // namespace mbk::preprocess
