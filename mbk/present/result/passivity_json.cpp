#include "mbk/present/result/passivity_json.h"

#include "mbk/present/result/json.h"

namespace mbk::result {
namespace {

Json model_passivity_json(const ModelPassivity& model) {
  Json json = {{"method", word_of(model.method)},
               {"verdict", word_of(model.verdict)},
               {"symmetric_part", word_of(model.symmetric_verdict)},
               {"published_rule", model.published_rule ? "passive" : "active"},
               {"band_hz", {model.band.low.value, model.band.high.value}},
               {"band_rule", model.band.rule},
               {"min_index", number(model.smallest_index)},
               {"min_index_interval95", interval(model.smallest_index95)},
               {"min_index_at_hz", model.smallest_at.value},
               {"nonpassive_below_hz", model.nonpassive_below_hz ? number(*model.nonpassive_below_hz) : Json(nullptr)},
               {"conditions", Json::array()}};
  for (const PassivityCondition& c : model.conditions) {
    json["conditions"].push_back({{"name", c.name},
                                  {"source", c.source},
                                  {"unit", c.unit},
                                  {"value", number(c.value)},
                                  {"standard_error", number(c.standard_error)},
                                  {"lower95", number(c.lower95)},
                                  {"upper", number(c.upper)},
                                  {"verdict", word_of(c.verdict)}});
  }
  if (model.excess) {
    json["eop"] = {{"corrected", number(model.excess->corrected)},
                   {"interval95", interval(model.excess->corrected95)},
                   {"published_formula", number(model.excess->published)},
                   {"published_formula_interval95", interval(model.excess->published95)}};
  }
  json["index"] = {{"frequency_hz", list(model.curve.frequency)},
                   {"value", list(model.curve.index)},
                   {"lower95", list(model.curve.lower95)},
                   {"upper95", list(model.curve.upper95)}};
  return json;
}

Json account_json(const EnergyAccount& account) {
  return {{"verdict", word_of(account.verdict)},
          {"reason", account.reason},
          {"absorbed_J", number(account.absorbed)},
          {"interval95", interval(account.absorbed95)},
          {"lower95_J", number(account.lower95)},
          {"upper95_J", number(account.upper95)},
          {"duration_s", number(account.duration)},
          {"mean_power_W", number(account.mean_power)},
          {"mean_power_interval95", interval(account.mean_power95)},
          {"squared_velocity", number(account.squared_velocity)},
          {"shortage",
           {{"at_end", number(account.shortage_at_end)},
            {"at_end_interval95", interval(account.shortage_at_end95)},
            {"largest", number(account.shortage_largest)},
            {"largest_interval95", interval(account.shortage_largest95)}}},
          {"blocks", account.blocks}};
}

}  // namespace

Json energy_json(const Energy& energy) {
  Json json = {{"window_s", {energy.from_s, energy.to_s}},
               {"account", account_json(energy.account)},
               {"shortage_largest_at_s", number(energy.shortage_largest_at_s)},
               {"whole_recording_J", number(energy.curve.end)},
               {"time_s", list(energy.curve.time)},
               {"absorbed_J", list(energy.curve.absorbed)},
               {"parts_are", energy.parts_are_perturbations ? "perturbations" : "blocks"},
               {"parts", Json::array()}};
  for (const EnergyPart& part : energy.parts) {
    json["parts"].push_back({{"from_s", part.from_s},
                             {"to_s", part.to_s},
                             {"absorbed_J", number(part.absorbed)},
                             {"largest_displacement", number(part.largest_displacement)},
                             {"path_length", number(part.path_length)},
                             {"squared_velocity", number(part.squared_velocity)},
                             {"shortage", number(part.shortage)}});
  }
  if (energy.curl) {
    json["curl"] = {{"k_a", number(energy.curl->k_a)},
                    {"absorbed_J", number(energy.curl->absorbed)},
                    {"share", number(energy.curl->share)},
                    {"over_time_J", list(energy.curve.curl)}};
  }
  return json;
}

Json passivity_json(const Passivity& passivity) {
  Json json = {{"verdict", word_of(passivity.verdict)},
               {"decided_by", passivity.by_model ? "model" : "energy"},
               {"reason", passivity.reason},
               {"explained_percent", number(passivity.explained)}};
  if (!passivity.models.empty()) {
    const Json model = model_passivity_json(passivity.models.front());
    json["band_hz"] = model["band_hz"];
    json["min_index"] = model["min_index"];
    if (model.contains("eop")) json["eop"] = model["eop"];
    json["models"] = Json::array();
    for (const ModelPassivity& one : passivity.models) json["models"].push_back(model_passivity_json(one));
  }
  if (passivity.energy) json["energy"] = account_json(*passivity.energy);
  return json;
}

std::string passivity_to_json(const std::vector<SourceFile>& sources, const Passivity& passivity,
                              const std::vector<Energy>& energies) {
  Json json = header("mbk.passivity/1");
  json["inputs"] = inputs_json(sources);
  json["passivity"] = passivity_json(passivity);
  json["recordings"] = Json::array();
  for (const Energy& energy : energies) json["recordings"].push_back(energy_json(energy));
  return dumped(json);
}

}  // namespace mbk::result
