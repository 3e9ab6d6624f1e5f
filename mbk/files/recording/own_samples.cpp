#include "mbk/files/recording/own_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/nan.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/stale_samples.h"

namespace mbk::recording {
namespace {

bool begins_with_any(std::string_view name, std::span<const std::string_view> beginnings) {
  return std::ranges::any_of(beginnings, [&](std::string_view beginning) { return name.starts_with(beginning); });
}

/// A channel that a controller may have set.
bool may_be_command(std::string_view name, std::span<const std::string> commands) {
  constexpr auto kCommands = std::to_array<std::string_view>({"torque_", "input", "drive", "schedule"});
  const auto is_called = [&](const std::string& command) {
    return std::ranges::any_of(kinds_called(command), [&](const ChannelKind* kind) { return kind->name == name; });
  };
  return begins_with_any(name, kCommands) || std::ranges::any_of(commands, is_called);
}

/// Second derivatives of the natural cubic spline through (x, y): a tridiagonal system, solved by elimination.
std::vector<double> curvatures(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  std::vector<double> curvature(n, 0.0), factor(n, 0.0);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double left = x[k] - x[k - 1], right = x[k + 1] - x[k];
    const double pivot = 2.0 * (left + right) - left * factor[k - 1];
    factor[k] = right / pivot;
    const double bend = 6.0 * ((y[k + 1] - y[k]) / right - (y[k] - y[k - 1]) / left);
    curvature[k] = (bend - left * curvature[k - 1]) / pivot;
  }
  for (std::size_t k = n; k-- > 1;) curvature[k - 1] -= k < n ? factor[k - 1] * curvature[k] : 0.0;
  return curvature;
}

/// Treatment of the samples that are not measurements.
struct Filled {
  Index bridged = 0, lost = 0;
};

Filled fill(const Vector& time, const std::vector<bool>& stale, Vector& values) {
  constexpr double kBridge = 0.05;    // [s]
  constexpr double kIntervals = 2.5;  // of the channel's own
  std::vector<double> x, y, intervals;
  for (Index i = 0; i < values.size(); ++i) {
    if (stale[static_cast<std::size_t>(i)] || !std::isfinite(values[i])) continue;
    if (!x.empty()) intervals.push_back(time[i] - x.back());
    x.push_back(time[i]);
    y.push_back(values[i]);
  }
  if (x.size() < 4) return {};
  const double longest = std::max(kBridge, kIntervals * numeric::median(std::move(intervals)));
  const std::vector<double> curvature = curvatures(x, y);
  Filled filled;
  std::size_t k = 0;  // x[k] is the first measurement that is not before the sample
  for (Index i = 0; i < values.size(); ++i) {
    while (k < x.size() && x[k] < time[i]) ++k;
    if (!stale[static_cast<std::size_t>(i)]) continue;
    if (k == 0 || k == x.size()) {  // nothing follows, or nothing came before: the held value is as good as any
      const double nearest = k == 0 ? x.front() - time[i] : time[i] - x.back();
      if (nearest > longest) values[i] = kNaN;
      continue;
    }
    const double h = x[k] - x[k - 1];
    if (h > longest) {
      values[i] = kNaN;
      ++filled.lost;
      continue;
    }
    const double b = (time[i] - x[k - 1]) / h, a = 1.0 - b;
    values[i] =
        a * y[k - 1] + b * y[k] + h * h / 6.0 * ((a * a * a - a) * curvature[k - 1] + (b * b * b - b) * curvature[k]);
    ++filled.bridged;
  }
  return filled;
}

std::string percent(double share) {
  return fmt::format("{:.2g} %", 100.0 * share);
}

Warning warning_of(const Channel& channel, const Filled& filled, double rate_hz) {
  const bool held = channel.updates.staleness == Staleness::held;
  std::string message = stale_text(channel, rate_hz);
  if (filled.bridged > 0) {
    message += held ? fmt::format(". It was interpolated between its own samples; components above {:.4g} Hz are lost",
                                  0.5 * rate_hz / channel.updates.interval)
                    : ". These samples were interpolated from their neighbours";
  }
  if (filled.lost > 0) message += fmt::format("; {} samples in longer gaps are NaN", filled.lost);
  return {
      held ? WarningCode::held_signal : WarningCode::missing_samples,
      std::move(message),
      held ? "record every channel at the rate of the recording; measure the delay of the force with 'mbk sensor delay'"
           : "correct the logging: record a sample only when it was measured",
      {},
      channel.name};
}

Warning warning_of_command(const Channel& channel, double rate_hz) {
  return {WarningCode::held_signal,
          stale_text(channel, rate_hz) +
              ". It was left unchanged, which is correct for a command but delays a measured signal by half an update",
          "record it at the rate of the recording, or check whether it is a command",
          {},
          channel.name};
}

bool rises(const Vector& time) {
  for (Index i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1])) return false;
  }
  return true;
}

}  // namespace

std::string stale_text(const Channel& channel, double rate_hz) {
  const Updates& updates = channel.updates;
  switch (updates.staleness) {
    case Staleness::held:
      return fmt::format("{} was updated at {:.4g} Hz in a recording of {:.4g} Hz: each value repeats until the next",
                         channel.name, rate_hz / updates.interval, rate_hz);
    case Staleness::repeated:
      return fmt::format("{} repeats its previous value in {} of its samples, although it moves", channel.name,
                         percent(updates.share));
    case Staleness::frozen:
      return fmt::format("{} freezes repeatedly, for {} of the time in total", channel.name, percent(updates.share));
    case Staleness::placeholder:
      return fmt::format("{} is exactly {:g} {} in {} of its samples, far from the samples before and after",
                         channel.name, updates.placeholder, channel.unit, percent(updates.share));
    case Staleness::none:
      break;
  }
  return {};
}

void find_updates(Recording& recording) {
  if (recording.untimed) return;
  for (Channel& channel : recording.channels) {
    if (channel.name.starts_with("reference")) continue;
    channel.updates = find_stale(channel.values).updates;
  }
}

Recording at_own_samples(Recording recording, std::span<const std::string> commands) {
  const auto is_stale = [](const Channel& channel) { return channel.updates.staleness != Staleness::none; };
  if (std::ranges::none_of(recording.channels, is_stale) || !rises(recording.time)) return recording;
  const Index n = recording.samples();
  const double rate_hz = static_cast<double>(n - 1) / (recording.time[n - 1] - recording.time[0]);
  for (Channel& channel : recording.channels) {
    if (!is_stale(channel)) continue;
    if (channel.updates.staleness == Staleness::held && may_be_command(channel.name, commands)) {
      recording.warnings.push_back(warning_of_command(channel, rate_hz));
      continue;
    }
    const Filled filled = fill(recording.time, find_stale(channel.values).samples, channel.values);
    recording.warnings.push_back(warning_of(channel, filled, rate_hz));
  }
  return recording;
}

}  // namespace mbk::recording
