#include "mbk/present/result/width_json.h"

#include <numbers>

#include "mbk/present/result/json_parts.h"

namespace mbk::result {

std::string width_to_json(const std::vector<SourceFile>& first, const std::vector<SourceFile>& second,
                          const WidthFindings& widths) {
  Json json = header("mbk.compare/1");
  json["first"] = inputs_json(first);
  json["second"] = inputs_json(second);
  json["width"] = Json::object();
  json["refused"] = Json::object();
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const char* const name = kMatrixNames[k];
    if (!widths.of[k]) {
      json["width"][name] = nullptr;
      json["refused"][name] = widths.refused[k];
      continue;
    }
    const WidthFinding& one = *widths.of[k];
    Json ratios = Json::array();
    for (const WidthRatio& ratio : one.ratios) {
      ratios.push_back({{"ratio", number(ratio.ratio)}, {"interval95", interval(ratio.ratio95)}});
      if (one.ratios.size() > 1) ratios.back()["direction_deg"] = 180.0 / std::numbers::pi * ratio.direction;
    }
    json["width"][name] = {{"distance", number(one.distance)},
                           {"interval95", interval(one.distance95)},
                           {"distinguishable", one.distinguishable},
                           {"surely_positive", one.surely_positive},
                           {"second_to_first", std::move(ratios)}};
  }
  return dumped(json);
}

}  // namespace mbk::result
