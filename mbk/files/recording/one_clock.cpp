#include "mbk/files/recording/one_clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "mbk/base/numeric/statistics.h"

namespace mbk::recording {
namespace {

double median_interval(const Vector& time) {
  if (time.size() < 2) return 0.0;
  const Vector intervals = time.tail(time.size() - 1) - time.head(time.size() - 1);
  return numeric::median({intervals.data(), intervals.data() + intervals.size()});
}

Result<void> check_rises(const Clock& clock) {
  if (!clock.time.allFinite()) {
    return bad_data(fmt::format("the time of '{}' contains non-finite values", clock.name),
                    "use channels of one stream only");
  }
  for (Index i = 1; i < clock.time.size(); ++i) {
    if (clock.time[i] > clock.time[i - 1]) continue;
    return bad_data(fmt::format("the time of '{}' does not increase: sample {} at {:.6f} s follows one at {:.6f} s",
                                clock.name, i + 1, clock.time[i], clock.time[i - 1]),
                    "use channels of one stream only: combining streams requires increasing times");
  }
  return {};
}

/// @param longest  [s] over which is interpolated    @param unbridged  counts samples in longer gaps
Vector interpolated(const Vector& from, const Vector& values, const Eigen::Ref<const Vector>& at, double longest,
                    Index& unbridged) {
  Vector result(at.size());
  Index after = 0;
  for (Index i = 0; i < at.size(); ++i) {
    while (after < from.size() && from[after] < at[i]) ++after;
    if (after < from.size() && from[after] == at[i]) {
      result[i] = values[after];
      continue;
    }
    const double interval = from[after] - from[after - 1];
    if (interval > longest) {
      result[i] = std::numeric_limits<double>::quiet_NaN();
      ++unbridged;
      continue;
    }
    const double part = (at[i] - from[after - 1]) / interval;
    result[i] = values[after - 1] + part * (values[after] - values[after - 1]);
  }
  return result;
}

}  // namespace

bool same_stamps(const Clock& a, const Clock& b) {
  const auto bytes = static_cast<std::size_t>(a.time.size()) * sizeof(double);
  return &a == &b ||
         (a.time.size() == b.time.size() && (bytes == 0 || std::memcmp(a.time.data(), b.time.data(), bytes) == 0));
}

double rate_of(const Clock& clock) {
  const double interval = median_interval(clock.time);
  return interval > 0.0 ? 1.0 / interval : 0.0;
}

Result<CommonClock> put_on_clock(const Clock& chosen, std::span<const ClockedSignal> signals) {
  if (chosen.time.size() == 0) return bad_data(fmt::format("'{}' has no samples", chosen.name), "name another clock");
  for (const ClockedSignal& signal : signals) {
    if (signal.values->size() == signal.clock->time.size()) continue;
    return bad_data(fmt::format("{} has {} samples, but the clock of '{}' has {}", signal.channel,
                                signal.values->size(), signal.clock->name, signal.clock->time.size()),
                    "name a channel of a stream");
  }
  // One stream is taken as it was recorded.
  if (std::ranges::all_of(signals, [&](const ClockedSignal& signal) { return same_stamps(*signal.clock, chosen); })) {
    return CommonClock{chosen.time, {}};
  }
  MBK_TRY(check_rises(chosen));
  double begin = chosen.time[0], end = chosen.time[chosen.time.size() - 1];
  for (const ClockedSignal& signal : signals) {
    if (same_stamps(*signal.clock, chosen)) continue;
    const Vector& time = signal.clock->time;
    if (time.size() == 0) {
      return bad_data(fmt::format("'{}' has no samples", signal.clock->name), "name a channel of another stream");
    }
    MBK_TRY(check_rises(*signal.clock));
    begin = std::max(begin, time[0]);
    end = std::min(end, time[time.size() - 1]);
  }
  const double* const stamps = chosen.time.data();
  const Index first = std::lower_bound(stamps, stamps + chosen.time.size(), begin) - stamps;
  const Index count = std::upper_bound(stamps, stamps + chosen.time.size(), end) - stamps - first;
  if (count <= 0) {
    return bad_data("the selected streams do not overlap in time",
                    "use channels of overlapping streams ('mbk info' lists them)");
  }

  CommonClock common{chosen.time.segment(first, count), {}};
  const double rate_hz = rate_of(chosen);
  for (const ClockedSignal& signal : signals) {
    if (same_stamps(*signal.clock, chosen)) {
      *signal.values = Vector(signal.values->segment(first, count));
      continue;
    }
    Index unbridged = 0;
    const double own_hz = rate_of(*signal.clock);
    const double longest = own_hz > 0.0 ? kLongestBridge / own_hz : std::numeric_limits<double>::infinity();
    *signal.values = interpolated(signal.clock->time, *signal.values, common.time, longest, unbridged);
    std::string note = fmt::format("{} of '{}' ({:.4g} Hz) was interpolated linearly to the clock of '{}' ({:.4g} Hz)",
                                   signal.channel, signal.clock->name, own_hz, chosen.name, rate_hz);
    if (own_hz > 1.2 * rate_hz) note += fmt::format("; components above {:.4g} Hz alias", rate_hz / 2);
    if (unbridged > 0) note += fmt::format("; {} samples in its gaps are NaN", unbridged);
    common.notes.push_back(std::move(note));
  }
  if (const Index left_out = chosen.time.size() - count; left_out > 0) {
    common.notes.push_back(
        fmt::format("{} samples of '{}' were omitted because not every stream covers them", left_out, chosen.name));
  }
  return common;
}

}  // namespace mbk::recording
