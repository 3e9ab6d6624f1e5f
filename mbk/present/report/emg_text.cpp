#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace emg_lines {

/// "+" where the position increases, or the angle in the plane, or the components.
std::string direction_name(const Vector& direction) {
  if (direction.size() == 1) return direction[0] > 0.0 ? "position +" : "position -";
  if (direction.size() == 2) return fmt::format("{:.0f}°", kDegrees * std::atan2(direction[1], direction[0]));
  return direction_text(direction);
}

std::string response_cell(const EmgWindowResponse& one) {
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]{}", one.ratio, one.interval95.first, one.interval95.second,
                     one.response == EmgChange::none       ? ""
                     : one.response == EmgChange::increase ? " +"
                                                           : " -");
}

std::string latency_cell(const EmgDirectionResponse& one) {
  if (one.latency) {
    return fmt::format("{:.1f} [{:.1f}, {:.1f}] ms", kMilliseconds * one.latency->value,
                       kMilliseconds * one.latency->interval95.first, kMilliseconds * one.latency->interval95.second);
  }
  for (const EmgWindowResponse& window : one.windows) {
    if (window.response != EmgChange::none) return "not found";
  }
  return "no response";
}

}  // namespace emg_lines

std::string emg_text(const EmgEstimate& found, Motion motion) {
  using namespace emg_lines;
  std::string text = "EMG after the onset of perturbations\n";
  const EmgProcessing& how = found.processing;
  std::vector<std::vector<std::string>> rows;
  rows.push_back({"onsets", fmt::format("{} found in the {}{}", found.onsets, found.onset_rule,
                                        found.omitted > 0 ? fmt::format("; {} omitted: too close to each other or to "
                                                                        "an end of the recording",
                                                                        found.omitted)
                                                          : "")});
  rows.push_back({"filter", fmt::format("{:g} to {:g} Hz, zero-phase Butterworth of order {}; rectified", how.low_hz,
                                        how.high_hz, how.order)});
  rows.push_back(
      {"background", fmt::format("mean of the {:.0f} ms before the onset", kMilliseconds * found.background_s)});
  for (const EmgDirection& one : found.directions) {
    const double scale = motion == Motion::rotation ? kDegrees : motion == Motion::translation ? kMillimetres : 1.0;
    const std::string smallest = fmt::format("{:.2g}", scale * one.smallest);
    const std::string largest = fmt::format("{:.2g}", scale * one.largest);
    rows.push_back({"direction", fmt::format("{}: {} perturbations of {}{} {}", direction_name(one.direction),
                                             one.trials, smallest == largest ? "" : smallest + " to ", largest,
                                             motion == Motion::rotation      ? "°"
                                             : motion == Motion::translation ? "mm"
                                                                             : "m or rad")});
  }
  text += table(rows);
  for (const EmgChannelEstimate& channel : found.channels) {
    std::string head = channel.name;
    if (!channel.usable) {
      head += ": not analysed";
    } else {
      head += channel.unit == "V"
                  ? fmt::format(": background {:.3g} µV", 1e6 * channel.background)
                  : fmt::format(": background {:.3g} (the recording states no unit)", channel.background);
      if (channel.mvc) head += fmt::format(", {:.1f} % of MVC", 100.0 * channel.background / *channel.mvc);
    }
    text += "\n" + head + "\n";
    for (const EmgFinding& finding : channel.findings) {
      text += paragraph("  ! ", fmt::format("{}: {}; {}", word_of(finding.problem), finding.message, finding.remedy));
    }
    if (channel.directions.empty()) continue;
    std::vector<std::vector<std::string>> lines;
    constexpr std::size_t kColumns = 2;  // beside each other within the width of a terminal
    for (std::size_t first = 0; first < channel.directions.size(); first += kColumns) {
      const std::size_t end = std::min(first + kColumns, channel.directions.size());
      const auto add = [&](std::string name, const auto& cell) {
        auto& line = lines.emplace_back();
        line.push_back(std::move(name));
        for (std::size_t d = first; d < end; ++d) line.push_back(cell(channel.directions[d]));
      };
      add("direction", [&](const EmgDirectionResponse& one) { return direction_name(one.direction); });
      for (std::size_t k = 0; k < found.windows.size(); ++k) {
        const EmgWindow& window = found.windows[k];
        add(fmt::format("{} ({:.0f}-{:.0f} ms)", window.name, kMilliseconds * window.from_s,
                        kMilliseconds * window.to_s),
            [&](const EmgDirectionResponse& one) { return response_cell(one.windows[k]); });
      }
      add("latency", latency_cell);
    }
    text += table(lines);
  }
  text += paragraph("  ",
                    "Windows: mean rectified EMG relative to the background, with 95 % intervals; + and - mark "
                    "responses (3 % of false responses in all windows of a direction together).");
  for (const std::string& note : found.notes) text += paragraph("  ", note);
  return text;
}

}  // namespace mbk::report
