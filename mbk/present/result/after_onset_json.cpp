#include "mbk/present/result/exploration_parts_json.h"

namespace mbk::result {
namespace after_onset_parts {

Json matrix(const MatrixEstimate& one) {
  return {{"value", rows(one.value)},
          {"half_width95", rows(one.half_width)},
          {"eigenvalues", list(one.eigenvalue)},
          {"eigenvalues_half_width95", list(one.eigenvalue_half_width)},
          {"identifiable", one.identifiable}};
}

}  // namespace after_onset_parts

Json after_onset_json(const AfterOnsetEstimate& found) {
  using namespace after_onset_parts;
  Json json = {{"window_s", number(found.window_s)},
               {"baseline_s", number(found.baseline_s)},
               {"onsets", found.onsets},
               {"omitted_onsets", found.omitted},
               {"displacement", number(found.displacement)},
               {"handle_mass", number(found.handle_mass)},
               {"degrees_of_freedom", number(found.degrees_of_freedom)},
               {"M", matrix(found.M)},
               {"B", matrix(found.B)},
               {"K", matrix(found.K)}};
  json["VAF"] = Json::array();
  json["RMSE"] = Json::array();
  for (const ExplainedForce& one : found.explained) {
    json["VAF"].push_back(number(one.vaf));
    json["RMSE"].push_back(number(one.rmse));
  }
  return json;
}

}  // namespace mbk::result
