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
#include "mbk/files/recording/si_units.h"

namespace mbk::recording {
namespace {

/// The median of the intervals above zero; 0 where there is none.
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
  std::vector<Period> all = {{3600.0, "a clock that is set back an hour"}, {86400.0, "a clock that passes midnight"}};
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

}  // namespace

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
  recording.notes.push_back(fmt::format(
      "time jumps back {} at sample {} ({:.6g} s), as {} does: it was taken to run on",
      times == 1 ? "once," : fmt::format("{} times, first", times), where + 1, time[where] - time[0], what));
}

Result<void> check_unit_of_time(const Recording& recording, bool said_by_user) {
  constexpr Index kFewest = 20;  // of which something can be computed
  if (said_by_user || recording.samples() < kFewest || recording.untimed || recording.time_from_rate ||
      recording.time_origin.source.empty())
    return {};
  constexpr double kSlowest = 3.0, kFastest = 5e4, kLongest = 12.0 * 3600.0;  // [Hz, Hz, s]
  const auto intervals = static_cast<double>(recording.samples() - 1);
  // Stamps that are coarser than the samples repeat: then the mean says more.
  const double step = std::min(median_interval(recording.time),
                               std::abs(recording.time[recording.samples() - 1] - recording.time[0]) / intervals);
  if (!(step > 0.0)) return {};
  const double rate = 1.0 / step, duration = step * intervals;
  if (rate > kSlowest && rate <= kFastest && duration < kLongest) return {};
  constexpr double kUsualSlowest = 10.0, kUsualFastest = 2e4;  // [Hz]
  std::vector<std::string> readings, maps;
  const std::string& source = recording.time_origin.source;
  const Unit* const unit = find_unit(recording.time_origin.unit);
  const double in_unit = unit != nullptr ? step / unit->to_si(1.0) : step;
  for (const Meaning& meaning : kMeanings) {
    const double hz = 1.0 / (in_unit * meaning.seconds);
    if (hz < kUsualSlowest || hz > kUsualFastest) continue;
    readings.push_back(fmt::format("in {} it lasts {} at {:.4g} Hz", meaning.name, lasting(intervals / hz), hz));
    maps.push_back(fmt::format("--channels time={}:{}", source, meaning.unit));
  }
  const std::string_view said = unit != nullptr ? unit->name : std::string_view("s");
  std::string remedy = maps.empty() ? std::string() : fmt::format("pass {}", fmt::join(maps, " or "));
  remedy +=
      fmt::format("{}time={}:{} if it is right as it is", remedy.empty() ? "pass --channels " : ", or ", source, said);
  const std::string in = unit == nullptr || said == "s" ? "seconds" : std::string(said);
  return bad_data(
      fmt::format("{}{}: '{}' advances by {:.6g} a sample, so that the recording would last {} at {:.4g} Hz{}{}",
                  kUnbelievableTime, in, source, in_unit, lasting(duration), rate, readings.empty() ? "" : "; ",
                  fmt::join(readings, "; ")),
      std::move(remedy));
}

}  // namespace mbk::recording
