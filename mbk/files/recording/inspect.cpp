#include "mbk/files/recording/inspect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::recording {
namespace {

constexpr double kGap = 1.5;  ///< median intervals
constexpr Index kRunLength = 5;
constexpr Index kRuns = 3;
constexpr double kClippedFraction = 0.002;

void find_non_finite(const std::string& name, const Vector& values, std::vector<NonFinite>& found) {
  if (values.allFinite()) return;
  const Index first = first_non_finite(values);
  found.push_back({name, values.size() - values.array().isFinite().cast<Index>().sum(), first});
}

void find_missing(const Recording& recording, std::vector<MissingSamples>& found) {
  const auto is_missing = [&](Index sample) {
    return std::ranges::all_of(recording.channels,
                               [&](const Channel& channel) { return std::isnan(channel.values[sample]); });
  };
  for (Index i = 0; i < recording.samples() && !recording.channels.empty(); ++i) {
    if (!is_missing(i)) continue;
    const Index first = i;
    while (i < recording.samples() && is_missing(i)) ++i;
    found.push_back({first, i - first, recording.time[first]});
  }
}

void inspect_time(const Vector& time, Inspection& facts) {
  facts.duration = time.size() > 0 ? time[time.size() - 1] - time[0] : 0.0;
  std::vector<double> intervals;
  intervals.reserve(static_cast<std::size_t>(time.size()));
  for (Index i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (!std::isfinite(interval)) continue;
    if (interval > 0.0) {
      intervals.push_back(interval);
    } else if (interval == 0.0) {
      if (facts.duplicated_times++ == 0) facts.first_duplicated = i;
    } else {
      if (facts.backward_times++ == 0) facts.first_backward = i;
    }
  }
  facts.interval_median = numeric::median(intervals);
  if (intervals.empty()) {
    facts.rate_hz = facts.interval_min = facts.interval_max = facts.interval_standard_deviation = kNaN;
    return;
  }
  const Eigen::Map<const Vector> d(intervals.data(), static_cast<Index>(intervals.size()));
  facts.interval_min = d.minCoeff();
  facts.interval_max = d.maxCoeff();
  const auto n = static_cast<double>(d.size());
  facts.interval_standard_deviation = d.size() > 1 ? std::sqrt((d.array() - d.mean()).square().sum() / (n - 1.0)) : 0.0;
  for (Index i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (interval > kGap * facts.interval_median) facts.gaps.push_back({i - 1, time[i - 1], interval});
  }
  // The mean does not carry the rounding of single time stamps.
  const bool unbroken = facts.gaps.empty() && static_cast<Index>(intervals.size()) + 1 == time.size();
  facts.rate_hz = 1.0 / (unbroken ? d.mean() : facts.interval_median);
}

bool can_clip(std::string_view name) {
  constexpr std::array<std::string_view, 4> kSensors{"force", "reaction", "acceleration", "torque"};
  return std::ranges::any_of(kSensors, [&](std::string_view sensor) { return name.starts_with(sensor); });
}

/// Of finite values between facts.min and facts.max.
void inspect_clipping(const Eigen::Ref<const Vector>& values, ChannelFacts& facts) {
  Index runs = 0;
  Index covered = 0;
  for (Index begin = 0; begin < values.size();) {
    Index end = begin + 1;
    if (values[begin] == facts.min || values[begin] == facts.max) {
      while (end < values.size() && values[end] == values[begin]) ++end;
      if (end - begin >= kRunLength) {
        ++runs;
        covered += end - begin;
      }
    }
    begin = end;
  }
  facts.clipped_fraction = static_cast<double>(covered) / static_cast<double>(values.size());
  facts.clipped = runs >= kRuns && facts.clipped_fraction >= kClippedFraction;
}

/// Of those of its values.
ChannelFacts inspect_channel(const Channel& channel, const Eigen::Ref<const Vector>& values) {
  ChannelFacts facts{channel.name, channel.unit, kNaN, kNaN};
  if (values.size() > 0 && values.allFinite()) {
    facts.min = values.minCoeff();
    facts.max = values.maxCoeff();
    facts.constant = facts.min == facts.max;
  } else {
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      facts.min = std::fmin(facts.min, value);
      facts.max = std::fmax(facts.max, value);
    }
  }
  if (can_clip(channel.name) && facts.min < facts.max) inspect_clipping(values, facts);
  return facts;
}

}  // namespace

Inspection inspect(const Recording& recording) {
  Inspection facts;
  facts.samples = recording.samples();
  inspect_time(recording.time, facts);
  find_missing(recording, facts.missing);
  find_non_finite("time", recording.time, facts.non_finite);
  for (const Channel& channel : recording.channels) {
    find_non_finite(channel.name, channel.values, facts.non_finite);
    facts.channels.push_back(inspect_channel(channel, channel.values));
  }
  return facts;
}

std::vector<ChannelFacts> clipped_channels(const Recording& recording, double from_s, double to_s) {
  std::vector<ChannelFacts> clipped;
  const Vector& time = recording.time;
  if (time.size() == 0) return clipped;
  const Index begin = std::ranges::lower_bound(time, time[0] + from_s) - time.begin();
  const Index end = std::ranges::upper_bound(time, time[0] + to_s) - time.begin();
  for (const Channel& channel : recording.channels) {
    if (!can_clip(channel.name) || begin >= end) continue;
    const ChannelFacts facts = inspect_channel(channel, channel.values.segment(begin, end - begin));
    if (facts.clipped) clipped.push_back(facts);
  }
  return clipped;
}

}  // namespace mbk::recording
