#include "mbk/present/result/springs_json.h"

#include <numbers>

#include "mbk/model/impedance/ellipse.h"
#include "mbk/present/result/json_parts.h"

namespace mbk::result {
namespace {

constexpr const char* kSpringsSchema = "mbk.springs/1";

Json springs_json(const char* what) {
  Json json = header(kSpringsSchema);
  json["what"] = what;
  return json;
}

void add_field(Json& json, const SpringField& field) {
  const impedance::Ellipse principal = impedance::ellipse(field.K);
  const double degrees = 180.0 / std::numbers::pi;
  json["equilibrium"] = list(field.equilibrium);
  json["K"] = rows(field.K);
  json["principal"] = {{"stiffness", {number(principal.lambda_max), number(principal.lambda_min)}},
                       {"orientation_deg", number(degrees * principal.orientation)}};
  json["residual_force"] = number(field.residual);
  json["moment"] = number(field.moment);
  json["disc_rotation_deg"] = number(degrees * field.disc_rotation);
  json["linearisation"] = {{"radius", number(field.linearisation.radius)},
                           {"largest_error", number(field.linearisation.largest_error)},
                           {"largest_force", number(field.linearisation.largest_force)},
                           {"relative_error", number(field.linearisation.relative_error())},
                           {"smallest_extension", number(field.linearisation.smallest_extension)}};
  json["springs"] = Json::array();
  for (std::size_t i = 0; i < field.springs.size(); ++i) {
    const Spring& spring = field.springs[i];
    json["springs"].push_back({{"stiffness", number(spring.stiffness)},
                               {"rest_length", number(spring.rest_length)},
                               {"anchor", list(spring.anchor)},
                               {"hole", list(spring.hole)},
                               {"length", number(field.lengths[i])},
                               {"tension", number(field.tensions[i])}});
  }
  if (field.grid) {
    json["grid"] = {{"step", number(field.grid->step)},
                    {"equilibrium", list(field.grid->equilibrium)},
                    {"residual_force", number(field.grid->residual)},
                    {"K", rows(field.grid->K)},
                    {"at_border", field.grid->at_border}};
  }
}

Json line_json(const SpringLine& line) {
  return {{"stiffness", number(line.stiffness)},
          {"stiffness_standard_error", number(line.stiffness_error)},
          {"rest", number(line.rest)},
          {"rest_standard_error", number(line.rest_error)},
          {"r_squared", number(line.r_squared)},
          {"RMSE", number(line.rmse)},
          {"tension", {number(line.tension_from), number(line.tension_to)}},
          {"samples", line.samples}};
}

}  // namespace

std::string to_json(const SpringField& field) {
  Json json = springs_json("field");
  add_field(json, field);
  return dumped(json);
}

std::string to_json(const SpringDesign& design) {
  Json json = springs_json("find");
  json["target"] = {{"K", rows(design.target_K)}, {"equilibrium", list(design.target_equilibrium)}};
  add_field(json, design.field);
  for (std::size_t i = 0; i < design.eyes.size(); ++i) json["springs"][i]["eye"] = design.eyes[i];
  if (design.payload) {
    json["payload"] = number(*design.payload);
    json["natural_frequencies_hz"] = list(design.natural_frequency);
  }
  return dumped(json);
}

std::string to_json(const std::vector<SpringConstant>& constants) {
  Json json = springs_json("calibrate");
  json["constants"] = Json::array();
  for (const SpringConstant& constant : constants) {
    Json one = {{"inputs", inputs_json(constant.sources)},
                {"straight", line_json(constant.straight)},
                {"whole", line_json(constant.whole)},
                {"bias_of_whole", number(constant.bias_of_whole())},
                {"rule", constant.rule},
                {"hac_lag_s", number(constant.hac_lag_s)}};
    if (constant.hooks) {
      const HookFit& hooks = *constant.hooks;
      one["hooks"] = {{"stiffness", number(hooks.stiffness)},
                      {"stiffness_standard_error", number(hooks.stiffness_error)},
                      {"rest", number(hooks.rest)},
                      {"deflection", number(hooks.deflection)},
                      {"deflection_standard_error", number(hooks.deflection_error)},
                      {"force", number(hooks.force)},
                      {"RMSE", number(hooks.rmse)}};
    }
    one["notes"] = constant.notes;
    json["constants"].push_back(std::move(one));
  }
  return dumped(json);
}

}  // namespace mbk::result
