#include <fmt/format.h>

#include <string>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/identification.h"
#include "mbk/present/report/exploration_parts_text.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace stretch_lines {

/// Scale and name of the position, speed and torque as they are shown.
struct StretchUnits {
  double scale = 1.0;
  const char *position = "", *speed = "", *torque = "", *slope = "";
};

StretchUnits shown_for(Motion motion) {
  if (motion == Motion::rotation) return {kDegrees, "°", "°/s", "N·m", "N·m·s/rad"};
  return {kMillimetres, " mm", " mm/s", "N", "N·s/m"};
}

std::string with_limits(const StretchValue& value, int decimals, double scale = 1.0) {
  std::string text = fmt::format("{:.{}f}", scale * value.value, decimals);
  if (!value.interval95) return text;
  return text + fmt::format(" [{:.{}f}, {:.{}f}]", scale * value.interval95->first, decimals,
                            scale * value.interval95->second, decimals);
}

std::string catch_text(const StretchSpeed& speed, bool slowest, const StretchUnits& shown) {
  if (slowest) return "(passive curve)";
  if (speed.catch_angle) return with_limits(*speed.catch_angle, 1, shown.scale) + shown.position;
  return speed.catch_finding == CatchFinding::none ? "no catch" : "not judged";
}

std::string verdict_text(const StretchDirection& found) {
  switch (found.verdict) {
    case VelocityDependence::velocity_dependent:
      return "velocity-dependent: " + found.verdict_reason;
    case VelocityDependence::not_shown:
      return "velocity dependence not shown: " + found.verdict_reason;
    case VelocityDependence::cannot_be_judged:
      break;
  }
  return "cannot be judged: " + found.verdict_reason;
}

std::string muscle_lines(const StretchDirection& found, const StretchUnits& shown) {
  if (found.muscles.empty()) return "";
  std::vector<std::vector<std::string>> rows = {{"muscle", "speed", "EMG onsets", "position at the onset"}};
  std::vector<std::vector<std::string>> thresholds;
  for (const StretchMuscle& muscle : found.muscles) {
    for (const StretchMuscleSpeed& one : muscle.speeds) {
      rows.push_back({&one == muscle.speeds.data() ? muscle.name : "",
                      fmt::format("{:.0f}{}", shown.scale * one.speed, shown.speed),
                      fmt::format("{} of {}", one.onsets, one.stretches),
                      one.onset_angle ? with_limits(*one.onset_angle, 1, shown.scale) + shown.position : ""});
    }
    std::string text = "not analysed: " + muscle.reason;
    if (muscle.threshold) {
      text = with_limits(*muscle.threshold, 1, shown.scale) + shown.position + "; " + muscle.threshold_note;
    } else if (muscle.usable) {
      text = (muscle.responds() ? "not identified: " : "no response: ") + muscle.threshold_note;
    }
    thresholds.push_back({muscle.name, text});
  }
  return "EMG in these stretches\n" + (rows.size() > 1 ? table(rows) : "") +
         "threshold at rest (λ), from the onsets of EMG\n" + table(thresholds);
}

std::string direction_lines(const StretchDirection& found, const StretchUnits& shown) {
  std::vector<std::vector<std::string>> rows = {
      {"speed", "stretches", "mean torque, " + std::string(shown.torque), "angle of catch", "work of the loop, J"}};
  for (std::size_t k = 0; k < found.speeds.size(); ++k) {
    const StretchSpeed& one = found.speeds[k];
    rows.push_back({fmt::format("{:.0f}{}", shown.scale * one.speed, shown.speed), fmt::format("{}", one.repetitions),
                    with_limits(one.mean_torque, 3), catch_text(one, k == 0, shown),
                    one.work ? with_limits(*one.work, 3) : ""});
  }
  std::string text = fmt::format("stretches with {} position, over {:.1f} to {:.1f}{}\n",
                                 found.direction > 0 ? "increasing" : "decreasing", shown.scale * found.range.first,
                                 shown.scale * found.range.second, shown.position) +
                     table(rows);
  rows = {{"torque", verdict_text(found)}};
  if (found.speeds.size() > 1) {
    rows.push_back({"slope over speed", with_limits(found.slope, 3) + " " + shown.slope});
    rows.push_back({"rise in the stretch",
                    with_limits(found.rise, 3) + " " + shown.slope + " (last third less first third, over speed)"});
    rows.push_back({"intervals", "rest on " + found.interval_basis});
    rows.push_back({"threshold at rest", found.reflex_threshold ? with_limits(*found.reflex_threshold, 1, shown.scale) +
                                                                      shown.position + "; " + found.threshold_note
                                                                : "not identified: " + found.threshold_note});
  }
  return text + table(rows) + muscle_lines(found, shown);
}

}  // namespace stretch_lines

std::string stretch_text(const StretchEstimate& found, Motion motion) {
  using namespace stretch_lines;
  const StretchUnits shown = shown_for(motion);
  std::string text;
  for (const StretchDirection& one : found.directions) text += (text.empty() ? "" : "\n") + direction_lines(one, shown);
  text += "\nwhat these data cannot show\n";
  for (const std::string& limit : found.limits) text += paragraph("  - ", limit);
  if (found.inertia_found) {
    text += paragraph("  - ",
                      fmt::format("inertia in the acceleration phases: {} {}, approximately",
                                  with_limits(*found.inertia_found, 3), motion == Motion::rotation ? "kg·m²" : "kg"));
  }
  if (!found.usable) text += "  not usable: see the warnings\n";
  return text;
}

}  // namespace mbk::report
