#include "mbk/present/result/passivity_json.h"

#include "mbk/present/result/json.h"
#include "mbk/present/result/json_reading.h"

namespace mbk::result {
namespace {

std::string prediction_word(const std::optional<Verdict>& verdict) {
  return std::string(verdict ? word_of(*verdict) : "none");
}

Json band_json(const PassivityBand& band) {
  return {band.low.value, band.high.value};
}

Json excess_json(const ExcessOfPassivity& excess) {
  return {{"corrected", number(excess.corrected)},
          {"interval95", interval(excess.corrected95)},
          {"published_formula", number(excess.published)},
          {"published_formula_interval95", interval(excess.published95)}};
}

Json model_passivity_json(const ModelPassivity& model) {
  Json json = {{"method", word_of(model.method)},
               {"VAF", list(model.vaf)},
               {"usable", model.usable},
               {"fits", model.fits},
               {"symmetric", word_of(model.symmetric)},
               {"antisymmetric", prediction_word(model.antisymmetric)},
               {"published_rule", model.published_rule ? "passive" : "active"},
               {"band_hz", band_json(model.band)},
               {"band_rule", model.band.rule},
               {"extrapolated", model.band.extrapolated},
               {"min_index", number(model.smallest_index)},
               {"min_index_interval95", interval(model.smallest_index95)},
               {"min_index_at_hz", model.smallest_at.value},
               {"circular_hz", model.circular_hz ? interval(*model.circular_hz) : Json(nullptr)},
               {"conditions", Json::array()}};
  for (const PassivityCondition& c : model.conditions) {
    json["conditions"].push_back({{"name", c.name},
                                  {"source", c.source},
                                  {"unit", c.unit},
                                  {"value", number(c.value)},
                                  {"standard_error", number(c.standard_error)},
                                  {"lower", number(c.lower)},
                                  {"upper", number(c.upper)},
                                  {"verdict", word_of(c.verdict)}});
  }
  if (model.excess) json["eop"] = excess_json(*model.excess);
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

Json trial_json(const TrialPassivity& trial) {
  Json json = {{"verdict", word_of(trial.energy.verdict)},
               {"absorbed_J", number(trial.energy.absorbed)},
               {"interval95", interval(trial.energy.absorbed95)},
               {"statement", trial.statement},
               {"reason", trial.energy.reason}};
  for (const EnergyLine& line : trial.lines) {
    json["lines"].push_back({{"frequency_hz", line.frequency.value},
                             {"duration_s", number(line.duration)},
                             {"absorbed_J", number(line.absorbed)},
                             {"interval95", interval(line.absorbed95)}});
  }
  return json;
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
  const PassivityPrediction& prediction = passivity.prediction;
  Json json = Json::object();
  if (passivity.trial) json["trial"] = trial_json(*passivity.trial);
  json["prediction"] = {{"verdict", prediction_word(prediction.verdict)},
                        {"symmetric", prediction_word(prediction.symmetric)},
                        {"antisymmetric", prediction_word(prediction.antisymmetric)},
                        {"extrapolated", prediction.extrapolated},
                        {"statement", prediction.statement}};
  json["band_hz"] = passivity.band ? band_json(*passivity.band) : Json(nullptr);
  if (!passivity.models.empty()) {
    if (prediction.verdict) {
      const ModelPassivity& model = passivity.models.front();
      json["min_index"] = number(model.smallest_index);
      if (model.excess) json["eop"] = excess_json(*model.excess);
    }
    json["models"] = Json::array();
    for (const ModelPassivity& one : passivity.models) json["models"].push_back(model_passivity_json(one));
  }
  if (passivity.trial) json["energy"] = account_json(passivity.trial->energy);
  return json;
}

namespace {

Interval interval_from(const Json& object, const char* name) {
  const Vector ends = list_from(object, name, 2);
  return {ends[0], ends[1]};
}

/// Its verdict is that of the interval, whatever rule an older version had.
EnergyAccount account_from(const Json& json) {
  const auto value = [](const Json& object, const char* name) {
    return object.contains(name) ? number_from(object[name]) : kNaN;
  };
  EnergyAccount account;
  account.absorbed = number_from(json.at("absorbed_J"));
  account.absorbed95 = interval_from(json, "interval95");
  account.lower95 = value(json, "lower95_J");
  account.upper95 = value(json, "upper95_J");
  account.duration = value(json, "duration_s");
  account.mean_power = value(json, "mean_power_W");
  account.mean_power95 = interval_from(json, "mean_power_interval95");
  account.squared_velocity = value(json, "squared_velocity");
  const Json& shortage = json.at("shortage");
  account.shortage_at_end = value(shortage, "at_end");
  account.shortage_at_end95 = interval_from(shortage, "at_end_interval95");
  account.shortage_largest = value(shortage, "largest");
  account.shortage_largest95 = interval_from(shortage, "largest_interval95");
  account.blocks = json.value("blocks", Index{0});
  account.verdict = verdict_of(account.absorbed95);
  return account;
}

}  // namespace

StoredPassivity stored_passivity_from(const Json& json) {
  StoredPassivity stored;
  const auto models = json.find("models");
  const Json* first = models != json.end() && models->is_array() && !models->empty() ? &models->front() : nullptr;
  if (first != nullptr) stored.predicts = value_of<Method>(first->value("method", ""));
  // The first version wrote the excited band where there was no other, and only the rule says so.
  const bool coherent = json.contains("prediction") ||
                        (first != nullptr && first->value("band_rule", "").starts_with("the part of the excited band"));
  const auto band_of = [](const Json& object, bool extrapolated) -> std::optional<PassivityBand> {
    const auto band = object.find("band_hz");
    if (band == object.end() || !band->is_array()) return std::nullopt;
    const auto [low, high] = interval_from(object, "band_hz");
    return PassivityBand{Hertz(low), Hertz(high), object.value("band_rule", "as stored with the result"), extrapolated};
  };
  if (coherent) stored.band = band_of(json, false);
  if (first != nullptr) stored.judged = band_of(*first, first->value("extrapolated", !coherent));
  if (const auto energy = json.find("energy"); energy != json.end() && energy->is_object()) {
    stored.energy = account_from(*energy);
    if (json.contains("prediction")) stored.energy->reason = energy->value("reason", "");
  }
  const Json::json_pointer lines("/trial/lines");
  if (json.contains(lines) && json[lines].is_array()) {
    for (const Json& line : json[lines]) {
      stored.lines.push_back({Hertz(number_from(line.at("frequency_hz"))), number_from(line.at("duration_s")),
                              number_from(line.at("absorbed_J")), interval_from(line, "interval95")});
    }
  }
  return stored;
}

std::string passivity_to_json(const std::vector<SourceFile>& sources, const Passivity& passivity,
                              const std::vector<Energy>& energies) {
  Json json = header("mbk.passivity/2");
  json["inputs"] = inputs_json(sources);
  json["passivity"] = passivity_json(passivity);
  json["recordings"] = Json::array();
  for (const Energy& energy : energies) json["recordings"].push_back(energy_json(energy));
  return dumped(json);
}

}  // namespace mbk::result
