#include "mbk/present/result/movement_json.h"

#include <numbers>

#include "mbk/present/result/json_parts.h"

namespace mbk::result {

std::string to_json(std::span<const MovementQuality> all) {
  Json json = header("mbk.movement/1");
  json["recordings"] = Json::array();
  for (const MovementQuality& one : all) {
    Json recording = {
        {"file", one.source.path},  {"sha256", one.source.sha256},        {"format", one.source.format},
        {"axes", one.axes},         {"rate_hz", number(one.rate_hz)},     {"from_s", number(one.from_s)},
        {"to_s", number(one.to_s)}, {"cutoff_hz", number(one.cutoff_hz)}, {"rest_speed", number(one.rest_speed)}};
    if (!one.source.trial.empty()) recording["trial"] = one.source.trial;
    recording["reaches"] = Json::array();
    const auto maybe = [](const std::optional<double>& value, double scale = 1.0) {
      return value ? number(scale * *value) : Json(nullptr);
    };
    for (const Reach& reach : one.reaches) {
      recording["reaches"].push_back({{"begin_s", number(reach.begin_s)},
                                      {"end_s", number(reach.end_s)},
                                      {"sparc", number(reach.sparc)},
                                      {"ldlj", number(reach.ldlj)},
                                      {"peaks", reach.peaks},
                                      {"mean_speed", number(reach.mean_speed)},
                                      {"peak_speed", number(reach.peak_speed)},
                                      {"path", number(reach.path)},
                                      {"distance", number(reach.distance)},
                                      {"path_ratio", maybe(reach.path_ratio)},
                                      {"endpoint_error", maybe(reach.endpoint_error)},
                                      {"robot_work_J", maybe(reach.robot_work)},
                                      {"force_angle_deg", maybe(reach.force_angle, 180.0 / std::numbers::pi)}});
    }
    recording["notes"] = one.notes;
    recording["warnings"] = warnings_json(one.warnings);
    json["recordings"].push_back(std::move(recording));
  }
  return dumped(json);
}

}  // namespace mbk::result
