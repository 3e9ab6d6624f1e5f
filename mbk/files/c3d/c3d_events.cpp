#include "mbk/files/c3d/c3d_events.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/core/printable.h"
#include "mbk/files/c3d/c3d.h"

namespace mbk::recording {
namespace {

constexpr std::uint16_t kFourLetterLabels = 12345;
constexpr std::size_t kKeyAt = 298, kCountAt = 300, kTimesAt = 304, kLabelsAt = 396;  ///< bytes of the header
constexpr std::size_t kMaxInHeader = 18;
constexpr double kSameTime = 1e-4;  ///< [s]: two records of one event differ by the rounding of 32-bit reals

std::string without_padding(std::string text) {
  text.resize(text.find_last_not_of(' ') + 1);
  return text;
}

std::string named(std::string name) {
  return name.empty() ? "event" : name;
}

struct MinutesAndSeconds {
  double minutes = 0.0, seconds = 0.0;
};

/// TIMES of a group of `count` events. The two numbers of an event are adjacent if the dimensions are 2×n, or n with
/// two numbers for each event and whole minutes. If they are n×2, the minutes of all events precede the seconds.
std::vector<MinutesAndSeconds> times_of(const C3dParameters& parameters, std::string_view group, std::size_t count) {
  const C3dParameter* stored = parameters.find(group, "TIMES");
  if (stored == nullptr) return {};
  const auto numbers = parameters.numbers(group, "TIMES");
  const auto& dimensions = stored->dimensions;
  const bool table = dimensions.size() == 2 && numbers.size() % 2 == 0;
  bool whole = true;
  for (std::size_t k = 0; k < numbers.size(); k += 2) whole = whole && numbers[k] == std::floor(numbers[k]);
  const bool pairs = (table && dimensions[0] == 2) || (!table && numbers.size() == 2 * count && whole);
  const bool columns = table && !pairs && dimensions[1] == 2 && numbers.size() != count;
  const std::size_t n = pairs || columns ? numbers.size() / 2 : numbers.size();
  std::vector<MinutesAndSeconds> times(n);
  for (std::size_t k = 0; k < n; ++k) {
    if (pairs) {
      times[k] = {numbers[2 * k], numbers[2 * k + 1]};
    } else if (columns) {
      times[k] = {numbers[k], numbers[n + k]};
    } else {
      times[k].seconds = numbers[k];
    }
  }
  return times;
}

void add(std::vector<Event>& events, Event event) {
  const bool known = std::ranges::any_of(events, [&](const Event& other) {
    return other.name == event.name && std::abs(other.time - event.time) < kSameTime;
  });
  if (!known) events.push_back(std::move(event));
}

}  // namespace

std::vector<Event> c3d_events(const C3dBytes& file, const C3dParameters& parameters, double rate_hz, double first_frame,
                              double seconds, std::vector<std::string>& notes) {
  std::vector<Event> events;
  std::size_t no_time = 0;
  const double from = rate_hz > 0.0 && first_frame > 1.0 ? (first_frame - 1.0) / rate_hz : 0.0;
  const auto recorded = [&](double time) { return seconds > 0.0 && time >= from && time <= from + seconds; };
  bool shifted = false, minutes_ignored = false;
  for (const std::string_view group : {"EVENT", "EVENTS"}) {
    const auto labels = parameters.texts(group, "LABELS");
    const auto contexts = parameters.texts(group, "CONTEXTS");
    const std::size_t used =
        static_cast<std::size_t>(std::clamp(parameters.number(group, "USED").value_or(65535.0), 0.0, 65535.0));
    auto values = group == "EVENT" ? parameters.numbers_in_digits(kOwnC3dGroup, "EVENT_VALUES") : std::vector<double>();
    if (values.size() != used) values.assign(used, 0.0);  // other events than mbk wrote
    const std::vector<MinutesAndSeconds> times = times_of(parameters, group, labels.empty() ? used : labels.size());
    for (std::size_t k = 0; k < std::min(used, times.size()); ++k) {
      double time = 60.0 * times[k].minutes + times[k].seconds;
      if (group == "EVENTS" && times[k].minutes != 0.0 && !recorded(time) && recorded(times[k].seconds)) {
        time = times[k].seconds;
        minutes_ignored = true;
      }
      if (!std::isfinite(time)) {
        ++no_time;
        continue;
      }
      const std::string context = k < contexts.size() ? contexts[k] : "";
      const std::string label = k < labels.size() ? labels[k] : "";
      events.push_back(
          {time - from, named(context.empty() || label.empty() ? context + label : context + " " + label), values[k]});
      shifted = from > 0.0;
    }
  }

  const std::size_t in_header = file.word(kKeyAt) == kFourLetterLabels ? file.word(kCountAt) : 0;
  for (std::size_t k = 0; k < in_header && k < kMaxInHeader; ++k) {
    const double time = file.real(kTimesAt + 4 * k);
    std::string name = without_padding(printable(file.view.part(kLabelsAt + 4 * k, 4).padded_text()));
    if (std::isfinite(time)) {
      add(events, {time, named(std::move(name))});
    } else {
      ++no_time;
    }
  }
  if (in_header > kMaxInHeader) {
    notes.push_back(fmt::format("the header states {} events but has room for {}", in_header, kMaxInHeader));
  }
  if (no_time > 0) notes.push_back(fmt::format("{} events have no time and were ignored", no_time));
  if (minutes_ignored) {
    notes.emplace_back(
        "the first row of EVENTS:TIMES was ignored: read as minutes, it lies beyond the end of the recording");
  }
  if (shifted) {
    notes.push_back(fmt::format("the first frame has number {}; event times are relative to it", first_frame));
  }
  std::ranges::stable_sort(events, {}, &Event::time);
  return events;
}

}  // namespace mbk::recording
