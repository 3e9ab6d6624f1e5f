#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/document/json_values.h"
#include "mbk/model/trial/chart.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

/// What every JSON document of mbk is put together from. For the sources of this module only.
namespace mbk::result {

using document::dumped;
using document::header;
using document::interval;
using document::Json;
using document::kDigits;
using document::kTimeDigits;
using document::list;
using document::number;
using document::rounded;
using document::rows;

inline Json units_json(Motion motion) {
  const Units units = units_of(motion);
  return {{"M", units.inertia},
          {"B", units.damping},
          {"K", units.stiffness},
          {"x0", units.position},
          {"force", units.force}};
}

/// What the fit was judged on.
inline const char* validated_on(bool held_out) {
  return held_out ? "held-out" : "in-sample";
}

inline Json inputs_json(const std::vector<SourceFile>& sources) {
  Json inputs = Json::array();
  for (const SourceFile& source : sources) {
    inputs.push_back({{"file", source.path}, {"sha256", source.sha256}, {"format", source.format}});
    if (!source.trial.empty()) inputs.back()["trial"] = source.trial;
  }
  return inputs;
}

inline Json warnings_json(const std::vector<Warning>& warnings) {
  Json array = Json::array();
  for (const Warning& warning : warnings) {
    Json one = {{"code", word_of(warning.code)}, {"message", warning.message}, {"try", warning.remedy}};
    const std::string_view was = warning.was.empty() ? former_word_of(warning.code) : warning.was;
    if (!was.empty()) one["was"] = was;
    array.push_back(std::move(one));
  }
  return array;
}

inline Json preparation_json(const Preparation& how) {
  Json json = {{"protocol", word_of(how.protocol)},
               {"protocol_rule", how.protocol_rule},
               {"window_rule", how.window_rule},
               {"from_s", how.from_s},
               {"to_s", how.to_s},
               {"savitzky_golay", {{"order", how.smoothing_order}, {"window", how.smoothing_window}}},
               {"cutoff_hz", how.cutoff ? Json(how.cutoff->value) : Json(nullptr)},
               {"cutoff_rule", how.cutoff_rule},
               {"every", how.every},
               {"excited_band_hz", {how.band_low.value, how.band_high.value}},
               {"force_source", word_of(how.force_source)},
               {"acceleration",
                word_of(how.acceleration_from_sensor ? AccelerationSource::sensor : AccelerationSource::derivative)},
               {"cut_before_filter", how.cut_before_filter}};
  if (how.split_s) json["split_s"] = *how.split_s;
  if (how.protocol == Protocol::underdamped) json["perturbations"] = how.perturbations;
  if (how.mode == Mode::reference) json["procedure"] = word_of(how.procedure);
  return json;
}

/// Lines of a chart that are there to compare with.
inline Json references_json(const std::vector<ChartReference>& lines) {
  Json array = Json::array();
  for (const ChartReference& line : lines) array.push_back({{"value", number(line.value)}, {"name", line.name}});
  return array;
}

}  // namespace mbk::result
