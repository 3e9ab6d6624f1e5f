#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "mbk/base/document/json_values.h"
#include "mbk/model/trial/chart.h"

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

/// Lines of a chart that are there to compare with.
inline Json references_json(const std::vector<ChartReference>& lines) {
  Json array = Json::array();
  for (const ChartReference& line : lines) array.push_back({{"value", number(line.value)}, {"name", line.name}});
  return array;
}

}  // namespace mbk::result
