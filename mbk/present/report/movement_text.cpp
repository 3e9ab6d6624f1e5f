#include "mbk/present/report/movement_text.h"

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/model/trial/identification.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {

std::string movement_text(const MovementQuality& found) {
  const std::string unit = units_of(found.motion).position;
  using Of = std::function<std::optional<double>(const Reach&)>;
  struct Measure {
    std::string name;
    const char* format;
    Of of;
  };
  const std::vector<Measure> measures = {
      {"from s", "{:.2f}", [](const Reach& r) { return r.begin_s; }},
      {"to s", "{:.2f}", [](const Reach& r) { return r.end_s; }},
      {"SPARC", "{:.3f}", [](const Reach& r) { return r.sparc; }},
      {"LDLJ", "{:.3f}", [](const Reach& r) { return r.ldlj; }},
      {"peaks", "{:.0f}", [](const Reach& r) { return static_cast<double>(r.peaks); }},
      {"mean " + unit + "/s", "{:.3g}", [](const Reach& r) { return r.mean_speed; }},
      {"max " + unit + "/s", "{:.3g}", [](const Reach& r) { return r.peak_speed; }},
      {"distance " + unit, "{:.3g}", [](const Reach& r) { return r.distance; }},
      {"path ratio", "{:.3f}", [](const Reach& r) { return r.path_ratio; }},
      {"error " + unit, "{:.2g}", [](const Reach& r) { return r.endpoint_error; }},
      {"work J", "{:.3g}", [](const Reach& r) { return r.robot_work; }},
      {"angle °", "{:.0f}",
       [&](const Reach& r) { return r.force_angle ? std::optional(kDegrees * *r.force_angle) : std::nullopt; }}};
  std::vector<std::vector<std::string>> rows(found.reaches.size() + (found.reaches.size() > 1 ? 2 : 1));
  for (const Measure& measure : measures) {
    std::vector<double> values;
    for (const Reach& reach : found.reaches) {
      if (const auto value = measure.of(reach)) values.push_back(*value);
    }
    if (values.empty()) continue;
    rows.front().push_back(measure.name);
    for (std::size_t k = 0; k < found.reaches.size(); ++k) {
      const auto value = measure.of(found.reaches[k]);
      rows[k + 1].push_back(value ? fmt::format(fmt::runtime(measure.format), *value) : "—");
    }
    if (found.reaches.size() > 1) {
      const bool time = measure.name == "from s" || measure.name == "to s";
      rows.back().push_back(time ? (measure.name == "from s" ? "median" : "")
                                 : fmt::format(fmt::runtime(measure.format), numeric::median(values)));
    }
  }
  std::string text = table({{found.source.label().empty() ? "recording" : found.source.label(),
                             fmt::format("{} reach{} from {:.2f} to {:.2f} s at {:.6g} Hz; at rest below {:.3g} {}/s",
                                         found.reaches.size(), found.reaches.size() == 1 ? "" : "es", found.from_s,
                                         found.to_s, found.rate_hz, found.rest_speed, unit)}});
  text += "\n" + table(rows);
  for (const std::string& note : found.notes) text += paragraph("  ", note);
  if (!found.warnings.empty()) text += "\n" + warnings_text(found.warnings);
  return text;
}

}  // namespace mbk::report
