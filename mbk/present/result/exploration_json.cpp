#include "mbk/present/result/exploration_json.h"

#include "mbk/present/result/exploration_parts_json.h"

namespace mbk::result {

std::string to_json(const Exploration& found) {
  Json json = header("mbk.explore/1");
  json["inputs"] = Json::array();
  for (const ExploredRecording& one : found.recordings) {
    json["inputs"].push_back({{"file", one.source.path},
                              {"sha256", one.source.sha256},
                              {"format", one.source.format},
                              {"duration_s", number(one.duration_s)},
                              {"rate_hz", number(one.rate_hz)},
                              {"from_s", number(one.from_s)},
                              {"to_s", number(one.to_s)},
                              {"window_rule", one.window_rule}});
  }
  json["axes"] = found.axes;
  if (found.frequency_response) json["frequency_response"] = frequency_response_json(*found.frequency_response);
  if (found.impulse_response) json["impulse_response"] = impulse_response_json(*found.impulse_response);
  if (found.parallel_cascade) json["parallel_cascade"] = parallel_cascade_json(*found.parallel_cascade);
  json["notes"] = found.notes;
  json["warnings"] = warnings_json(found.warnings);
  json["usable"] = found.usable;
  return dumped(json);
}

}  // namespace mbk::result
