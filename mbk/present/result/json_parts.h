#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/document/json_values.h"
#include "mbk/model/trial/identification.h"
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

}  // namespace mbk::result
