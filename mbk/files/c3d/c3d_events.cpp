#include "mbk/files/c3d/c3d_events.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/core/printable.h"

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

void add(std::vector<Event>& events, Event event) {
  const bool known = std::ranges::any_of(events, [&](const Event& other) {
    return other.name == event.name && std::abs(other.time - event.time) < kSameTime;
  });
  if (!known) events.push_back(std::move(event));
}

}  // namespace

std::vector<Event> c3d_events(const C3dBytes& file, const C3dParameters& parameters, double rate_hz, double first_frame,
                              std::vector<std::string>& notes) {
  std::vector<Event> events;
  std::size_t no_time = 0;
  const double from = rate_hz > 0.0 && first_frame > 1.0 ? (first_frame - 1.0) / rate_hz : 0.0;
  bool shifted = false, row_ignored = false;
  for (const std::string_view group : {"EVENT", "EVENTS"}) {
    const C3dParameter* stored = parameters.find(group, "TIMES");
    if (stored == nullptr) continue;
    const auto times = parameters.numbers(group, "TIMES");
    const auto labels = parameters.texts(group, "LABELS");
    const auto contexts = parameters.texts(group, "CONTEXTS");
    const std::size_t each = stored->dimensions.size() == 2 && stored->dimensions.front() == 2 ? 2 : 1;
    const std::size_t used =
        static_cast<std::size_t>(std::clamp(parameters.number(group, "USED").value_or(65535.0), 0.0, 65535.0));
    for (std::size_t k = 0; k < std::min(used, times.size() / each); ++k) {
      const double minutes = each == 2 && group == "EVENT" ? times[2 * k] : 0.0;
      const double time = 60.0 * minutes + times[each * k + each - 1];
      row_ignored = row_ignored || (each == 2 && group == "EVENTS" && times[2 * k] != 0.0);
      if (!std::isfinite(time)) {
        ++no_time;
        continue;
      }
      const std::string context = k < contexts.size() ? contexts[k] : "";
      const std::string label = k < labels.size() ? labels[k] : "";
      events.push_back(
          {time - from, named(context.empty() || label.empty() ? context + label : context + " " + label)});
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
    notes.push_back(fmt::format("the header speaks of {} events and has room for {}", in_header, kMaxInHeader));
  }
  if (no_time > 0) notes.push_back(fmt::format("{} events have no time and were ignored", no_time));
  if (row_ignored) notes.emplace_back("the first of the two rows of EVENTS:TIMES is no time and was ignored");
  if (shifted) {
    notes.push_back(fmt::format("the first frame is number {}; the times of events count from there", first_frame));
  }
  std::ranges::stable_sort(events, {}, &Event::time);
  return events;
}

}  // namespace mbk::recording
