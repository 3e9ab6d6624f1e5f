#include "mbk/files/recording/believable_time.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/si_units.h"

namespace mbk::recording {
namespace {

/// The median of the positive intervals; 0 if there is none.
double median_interval(const Vector& time) {
  std::vector<double> intervals;
  for (Index i = 1; i < time.size(); ++i) {
    const double interval = time[i] - time[i - 1];
    if (interval > 0.0 && std::isfinite(interval)) intervals.push_back(interval);
  }
  return intervals.empty() ? 0.0 : numeric::median(std::move(intervals));
}

/// After how long a clock begins anew, and what does so.
struct Period {
  double seconds;
  std::string what;
};

std::vector<Period> periods(const std::string& unit) {
  std::vector<std::pair<std::string_view, double>> ticks = {
      {"second", 1.0}, {"millisecond", 1e-3}, {"microsecond", 1e-6}, {"nanosecond", 1e-9}};
  std::vector<Period> all = {{60.0, "a clock that restarts every minute"},
                             {3600.0, "a clock that was set back one hour"},
                             {86400.0, "a clock that passes midnight"}};
  for (const int bits : {16, 24, 31, 32}) {
    for (const auto& [name, seconds] : ticks) {
      all.push_back({std::ldexp(seconds, bits), fmt::format("a {}-bit counter of {}s", bits, name)});
    }
  }
  if (const Unit* const own = find_unit(unit); own != nullptr) {
    for (const int bits : {16, 24, 31, 32}) {
      all.push_back({own->to_si(std::ldexp(1.0, bits)), fmt::format("a {}-bit counter", bits)});
    }
  }
  return all;
}

struct Meaning {
  std::string_view unit, name;
  double seconds;
};
constexpr auto kMeanings = std::to_array<Meaning>({{"ms", "milliseconds", 1e-3},
                                                   {"us", "microseconds", 1e-6},
                                                   {"ns", "nanoseconds", 1e-9},
                                                   {"min", "minutes", 60.0},
                                                   {"h", "hours", 3600.0},
                                                   {"day", "days", 86400.0}});

std::string lasting(double seconds) {
  if (seconds < 120.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 7200.0) return fmt::format("{:.3g} min", seconds / 60.0);
  return seconds < 2.0 * 86400.0 ? fmt::format("{:.3g} h", seconds / 3600.0)
                                 : fmt::format("{:.3g} days", seconds / 86400.0);
}

/// [s] from sample to sample. Stamps that are coarser than the samples repeat: then the mean says more.
double step_of(const Vector& time) {
  constexpr double kRepeats = 0.1;
  const auto intervals = static_cast<double>(time.size() - 1);
  Index repeats = 0;
  for (Index i = 1; i < time.size(); ++i) repeats += time[i] == time[i - 1] ? 1 : 0;
  if (static_cast<double>(repeats) <= kRepeats * intervals) return median_interval(time);
  return std::abs(time[time.size() - 1] - time[0]) / intervals;
}

bool counts_samples(const Recording& recording) {
  const Unit* const unit = find_unit(recording.time_origin.unit);
  const double one = unit != nullptr ? unit->to_si(1.0) : 1.0;
  const auto whole = [&](double seconds) { return std::abs(seconds / one - std::round(seconds / one)) < 1e-6; };
  return std::abs(median_interval(recording.time) - one) < 1e-6 * one &&
         std::ranges::all_of(recording.time, [&](double time) { return whole(time - recording.time[0]); });
}

/// Whether stamps that repeat are those of even samples at that rate, told coarsely.
bool are_coarse_stamps(const Vector& time, double rate_hz) {
  constexpr double kStepsOff = 2.0;
  const double resolution = median_interval(time);
  if (resolution * rate_hz < 1.5) return false;
  for (Index i = 0; i < time.size(); ++i) {
    if (!(std::abs(time[i] - time[0] - static_cast<double>(i) / rate_hz) <= kStepsOff * resolution)) return false;
  }
  return true;
}

}  // namespace

bool is_believable(double rate_hz, Index samples) {
  constexpr Index kMin = 20;
  if (samples < kMin) return true;
  const double duration_s = static_cast<double>(samples - 1) / rate_hz;
  constexpr double kSlowest = 3.0, kFastest = 2.05e4, kLongest = 12.0 * 3600.0;  // [Hz, Hz, s]
  if (rate_hz <= kSlowest || rate_hz > kFastest || duration_s >= kLongest) return false;
  constexpr double kSlow = 20.0, kHour = 3600.0;
  if (rate_hz <= kSlow && duration_s > kHour) return false;
  // 50 Hz and its multiples for minutes, told in minutes.
  constexpr double kOfMinutes = 3000.0, kShort = 10.0, kNear = 1e-4;
  const double times = rate_hz / kOfMinutes;
  return !(duration_s < kShort && times > 0.5 && std::abs(times - std::round(times)) < kNear * times);
}

bool take_rate(Recording& recording, double rate_hz) {
  Vector& time = recording.time;
  const std::string& source = recording.time_origin.source;
  if (time.size() < 2 || source.empty()) return false;
  if (counts_samples(recording)) {
    const Unit* const unit = find_unit(recording.time_origin.unit);
    const double per_second = rate_hz * (unit != nullptr ? unit->to_si(1.0) : 1.0);
    time = (time.array() - time[0]) / per_second;
    recording.notes.push_back(fmt::format("time '{}' counts samples; it was divided by {:g} Hz", source, rate_hz));
    return true;
  }
  if (!are_coarse_stamps(time, rate_hz)) return false;
  recording.notes.push_back(
      fmt::format("time '{}' has a resolution of {:g} s; the samples were spaced {:g} s apart instead (--rate)", source,
                  median_interval(time), 1.0 / rate_hz));
  time = Vector::LinSpaced(time.size(), 0.0, static_cast<double>(time.size() - 1) / rate_hz);
  return true;
}

void unwrap_time(Recording& recording) {
  Vector& time = recording.time;
  const double step = median_interval(time);
  if (step == 0.0) return;
  constexpr double kSteps = 10.0;  // that may be lost where the clock begins anew
  const std::vector<Period> possible = periods(recording.time_origin.unit);
  const double first = time[0];
  double added = 0.0;
  std::string what;
  Index times = 0, where = 0;
  double last = time[0];  // as recorded
  for (Index i = 1; i < time.size(); ++i) {
    const double now = time[i], back = last - now;
    if (back > kSteps * step && std::abs(now - first) > kSteps * step) {
      const auto found = std::ranges::find_if(possible, [&](const Period& period) {
        const double on = period.seconds - back;
        return on > 0.0 && on < kSteps * step;
      });
      if (found != possible.end()) {
        added += found->seconds;
        what = found->what;
        if (times++ == 0) where = i;
      }
    }
    last = now;
    time[i] = now + added;
  }
  if (times == 0) return;
  recording.notes.push_back(fmt::format("time jumps back {} at sample {} ({:.6g} s), like {}; it was unwrapped",
                                        times == 1 ? "once," : fmt::format("{} times, first", times), where + 1,
                                        time[where] - time[0], what));
}

Result<void> check_unit_of_time(const Recording& recording, bool said_by_user) {
  if (said_by_user || recording.untimed || recording.time_from_rate || recording.time_origin.source.empty()) return {};
  const auto intervals = static_cast<double>(recording.samples() - 1);
  const double step = step_of(recording.time);
  if (!(step > 0.0)) return {};
  const double rate = 1.0 / step, duration = step * intervals;
  if (is_believable(rate, recording.samples())) return {};
  constexpr double kUsualSlowest = 10.0, kUsualFastest = 2e4;  // [Hz]
  std::vector<std::string> readings, maps;
  const std::string& source = recording.time_origin.source;
  const Unit* const unit = find_unit(recording.time_origin.unit);
  const double in_unit = unit != nullptr ? step / unit->to_si(1.0) : step;
  for (const Meaning& meaning : kMeanings) {
    const double hz = 1.0 / (in_unit * meaning.seconds);
    if (hz < kUsualSlowest || hz > kUsualFastest) continue;
    readings.push_back(fmt::format("in {} it would last {} at {:.4g} Hz", meaning.name, lasting(intervals / hz), hz));
    maps.push_back(fmt::format("--channels time={}:{}", source, meaning.unit));
  }
  const std::string_view said = unit != nullptr ? unit->name : std::string_view("s");
  constexpr double kTicks = 10.0;
  if (unit == nullptr && in_unit >= kTicks) {
    maps.push_back(fmt::format("--channels \"time={}*1e-7\" (a tick of 1e-7 s)", source));
  }
  std::string remedy = maps.empty() ? std::string() : fmt::format("pass {}", fmt::join(maps, " or "));
  if (counts_samples(recording)) remedy += ", or --rate HZ if it counts samples";
  remedy += fmt::format("{}time={}:{} if this is correct", remedy.empty() ? "pass --channels " : ", or ", source, said);
  const std::string in = unit == nullptr || said == "s" ? "seconds" : std::string(said);
  std::string message = fmt::format(
      "time is probably not in {}: '{}' advances by {:.6g} per sample, so the recording would last {} at {:.4g} Hz{}{}",
      in, source, in_unit, lasting(duration), rate, readings.empty() ? "" : "; ", fmt::join(readings, "; "));
  return with_code(kUnbelievableTime, bad_data(std::move(message), std::move(remedy)));
}

}  // namespace mbk::recording
