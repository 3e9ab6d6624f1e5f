#include "mbk/files/recording/inspect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/own_samples.h"

namespace mbk::recording {
namespace {

constexpr double kGap = 1.5;             ///< median intervals
constexpr double kGapOfJittering = 1.2;  ///< median intervals, where the clock jitters by more than kJitter
constexpr double kJitter = 0.02;         ///< of a median interval, robust standard deviation
constexpr Index kAround = 16;            ///< samples on either side of a gap that show whether time has moved on
constexpr Index kRunLength = 5;
constexpr Index kRuns = 3;
constexpr double kClippedFraction = 0.002;

void find_non_finite(const std::string& name, const Vector& values, const numeric::Extremes& finite,
                     std::vector<NonFinite>& found) {
  if (values.size() == 0 || !std::isnan(finite.min)) return;
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

std::vector<Gap> long_intervals(const Vector& time, double longer_than) {
  std::vector<Gap> found;
  for (Index i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (interval > longer_than) found.push_back({i - 1, time[i - 1], interval});
  }
  return found;
}

/// The interval of an even clock behind a jittering one: the median over many samples.
double even_interval(const Vector& time) {
  constexpr Index kLag = 64;
  std::vector<double> intervals;
  for (Index i = kLag; i < time.size(); ++i) intervals.push_back((time[i] - time[i - kLag]) / kLag);
  return numeric::median(intervals);
}

/// By how many intervals the samples from sample `after` on are later than those up to `before`, had none been lost.
double lost_intervals(const Vector& time, Index before, Index after, double interval) {
  const auto phase = [&](Index from, Index to) {
    std::vector<double> phases;
    for (Index i = from; i < to; ++i) phases.push_back(time[i] - static_cast<double>(i) * interval);
    return numeric::median(phases);
  };
  const double later = phase(after, std::min(time.size(), after + kAround));
  return (later - phase(std::max<Index>(0, before + 1 - kAround), before + 1)) / interval;
}

/// Of long intervals that follow each other closely, as many of the longest as samples were lost there.
void keep_longest(std::span<Gap> close, double lost, std::vector<Gap>& gaps) {
  const auto count = std::clamp<std::ptrdiff_t>(std::lround(lost), 1, std::ssize(close));
  std::ranges::sort(close, std::greater(), &Gap::length);
  std::ranges::sort(close.first(static_cast<std::size_t>(count)), {}, &Gap::sample);
  gaps.insert(gaps.end(), close.begin(), close.begin() + count);
}

/// A late stamp is followed by a short interval, a lost sample is not: behind it all stamps are later.
std::vector<Gap> gaps_of_jittering(const Vector& time, double median) {
  const double interval = even_interval(time);
  std::vector<Gap> lasting = long_intervals(time, kGapOfJittering * median), gaps;
  std::erase_if(lasting,
                [&](const Gap& gap) { return !(lost_intervals(time, gap.sample, gap.sample + 1, interval) > 0.5); });
  for (std::size_t begin = 0; begin < lasting.size();) {
    std::size_t end = begin + 1;
    while (end < lasting.size() && lasting[end].sample - lasting[end - 1].sample < kAround) ++end;
    const double lost = lost_intervals(time, lasting[begin].sample, lasting[end - 1].sample + 1, interval);
    keep_longest(std::span(lasting).subspan(begin, end - begin), lost, gaps);
    begin = end;
  }
  return gaps;
}

/// Statistics of the positive intervals of `time`, `from` of each, in blocks.
template <class From>
numeric::EachBlock each_interval(const Vector& time, const From& from) {
  return [&time, from](const std::function<void(std::span<const double>)>& use) {
    constexpr Index kBlock = 1 << 17;
    std::vector<double> block(static_cast<std::size_t>(std::min(kBlock, time.size())));
    for (Index begin = 1; begin < time.size(); begin += kBlock) {
      const Index end = std::min(time.size(), begin + kBlock);
      std::size_t count = 0;
      for (Index i = begin; i < end; ++i) {
        const double interval = time[i] - time[i - 1];
        block[count] = from(interval);
        count += interval > 0.0 && interval <= std::numeric_limits<double>::max() ? 1 : 0;
      }
      use(std::span(block).first(count));
    }
  };
}

/// @param positive  number of intervals above zero
std::vector<Gap> find_gaps(const Vector& time, Index positive, double median) {
  constexpr Index kMin = 256;
  constexpr double kNormal = 1.4826;  // standard deviations in a median absolute deviation
  const double deviation =
      numeric::median_of_many(positive, each_interval(time, [=](double d) { return std::abs(d - median); }));
  const bool jitters = kNormal * deviation > kJitter * median;
  if (!jitters || time.size() < kMin || first_non_finite(time) >= 0) return long_intervals(time, kGap * median);
  return gaps_of_jittering(time, median);
}

void inspect_time(const Vector& time, Inspection& facts) {
  facts.duration = time.size() > 0 ? time[time.size() - 1] - time[0] : 0.0;
  Index positive = 0;
  for (Index i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (!std::isfinite(interval)) continue;
    if (interval > 0.0) {
      ++positive;
    } else if (interval == 0.0) {
      if (facts.duplicated_times++ == 0) facts.first_duplicated = i;
    } else {
      if (facts.backward_times++ == 0) facts.first_backward = i;
    }
  }
  if (positive == 0) {
    facts.interval_median = kNaN;
    facts.rate_hz = facts.interval_min = facts.interval_max = facts.interval_standard_deviation = kNaN;
    return;
  }
  const auto as_they_are = each_interval(time, [](double interval) { return interval; });
  facts.interval_median = numeric::median_of_many(positive, as_they_are);
  const auto map = [](std::span<const double> block) {
    return Eigen::Map<const Eigen::ArrayXd>(block.data(), std::ssize(block));
  };
  const auto n = static_cast<double>(positive);
  double sum = 0.0, squares = 0.0;
  facts.interval_min = std::numeric_limits<double>::infinity();
  facts.interval_max = 0.0;
  as_they_are([&](std::span<const double> block) {
    if (block.empty()) return;
    sum += map(block).sum();
    facts.interval_min = std::min(facts.interval_min, map(block).minCoeff());
    facts.interval_max = std::max(facts.interval_max, map(block).maxCoeff());
  });
  const double mean = sum / n;
  as_they_are([&](std::span<const double> block) { squares += (map(block) - mean).square().sum(); });
  facts.interval_standard_deviation = positive > 1 ? std::sqrt(squares / (n - 1.0)) : 0.0;
  facts.gaps = find_gaps(time, positive, facts.interval_median);
  // The mean does not carry the rounding of single time stamps.
  const bool unbroken = facts.gaps.empty() && positive + 1 == time.size();
  facts.rate_hz = 1.0 / (unbroken ? mean : facts.interval_median);
}

bool can_clip(std::string_view name) {
  constexpr std::array<std::string_view, 4> kSensors{"force", "reaction", "acceleration", "torque"};
  return std::ranges::any_of(kSensors, [&](std::string_view sensor) { return name.starts_with(sensor); });
}

/// Of values between facts.min and facts.max. Every run that is long enough holds a sample whose number is a multiple
/// of that length, so that no others are looked at.
void inspect_clipping(const Eigen::Ref<const Vector>& values, ChannelFacts& facts) {
  Index runs = 0, covered = 0, next = 0;
  for (Index i = 0; i < values.size(); i += kRunLength) {
    if (i < next || (values[i] != facts.min && values[i] != facts.max)) continue;
    Index begin = i, end = i + 1;
    while (begin > next && values[begin - 1] == values[i]) --begin;
    while (end < values.size() && values[end] == values[i]) ++end;
    next = end;
    if (end - begin < kRunLength) continue;
    ++runs;
    covered += end - begin;
  }
  facts.clipped_fraction = static_cast<double>(covered) / static_cast<double>(values.size());
  facts.clipped = runs >= kRuns && facts.clipped_fraction >= kClippedFraction;
}

/// Of those of its values.
ChannelFacts inspect_channel(const Channel& channel, const Eigen::Ref<const Vector>& values,
                             const numeric::Extremes& finite) {
  ChannelFacts facts{channel.name, channel.unit, finite.min, finite.max};
  facts.constant = facts.min == facts.max;
  if (std::isnan(finite.min)) {
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
  find_non_finite("time", recording.time, numeric::finite_extremes(recording.time), facts.non_finite);
  find_missing(recording, facts.missing);
  for (const Channel& channel : recording.channels) {
    const numeric::Extremes finite = numeric::finite_extremes(channel.values);
    find_non_finite(channel.name, channel.values, finite, facts.non_finite);
    ChannelFacts& here = facts.channels.emplace_back(inspect_channel(channel, channel.values, finite));
    here.updates = channel.updates;
    here.update_hz = facts.rate_hz / channel.updates.interval;
    here.stale = stale_text(channel, facts.rate_hz);
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
    const auto values = channel.values.segment(begin, end - begin);
    const ChannelFacts facts = inspect_channel(channel, values, numeric::finite_extremes(values));
    if (facts.clipped) clipped.push_back(facts);
  }
  return clipped;
}

}  // namespace mbk::recording
