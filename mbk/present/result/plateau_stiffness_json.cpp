#include "mbk/present/result/exploration_parts_json.h"
#include "mbk/present/result/findings_json.h"

namespace mbk::result {
namespace plateau_stiffness {

Json displaced_json(const std::vector<DisplacedHand>& displaced) {
  Json array = Json::array();
  for (const DisplacedHand& one : displaced) {
    array.push_back({{"input", one.recording},
                     {"onset_s", rounded(one.onset_s, kTimeDigits)},
                     {"commanded", rounded(one.commanded)},
                     {"displacement", rounded(one.displacement)},
                     {"force", rounded(one.force)}});
  }
  return array;
}

}  // namespace plateau_stiffness

Json stiffness_regression_json(const StiffnessRegression& fit) {
  Json interval95 = Json::array();
  for (Index r = 0; r < fit.K.rows(); ++r) {
    Json row = Json::array();
    for (Index k = 0; k < fit.K.cols(); ++k) {
      row.push_back(interval({fit.K(r, k) - fit.half_width95(r, k), fit.K(r, k) + fit.half_width95(r, k)}));
    }
    interval95.push_back(std::move(row));
  }
  Json json = {{"K", rows(fit.K)},
               {"standard_error", rows(fit.standard_error)},
               {"interval95", std::move(interval95)},
               {"degrees_of_freedom", number(fit.degrees_of_freedom)},
               {"relative_error", number(fit.relative_error)},
               {"residual_rms", list(fit.residual_rms)},
               {"displacements", fit.displacements},
               {"directions", fit.directions},
               {"amplitude", number(fit.amplitude)},
               {"reached", number(fit.reached)}};
  if (fit.linear_p) json["linear_p"] = number(*fit.linear_p);
  if (fit.ellipse) json["ellipse"] = ellipse_json(*fit.ellipse);
  if (fit.antisymmetry) json["antisymmetry"] = antisymmetry_json(*fit.antisymmetry);
  return json;
}

Json plateau_stiffness_json(const PlateauStiffness& found) {
  return {{"stiffness", stiffness_regression_json(found.fit)},
          {"plateau_s", {number(found.from_s), number(found.to_s)}},
          {"window_rule", found.window_rule},
          {"baseline_s", number(found.baseline_s)},
          {"motion_share", number(found.motion_share)},
          {"left_out", found.left_out},
          {"plateaus", plateau_stiffness::displaced_json(found.plateaus)},
          {"usable", found.usable}};
}

}  // namespace mbk::result
