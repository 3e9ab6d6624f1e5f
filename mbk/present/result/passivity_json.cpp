#include "mbk/present/result/passivity_json.h"

#include "mbk/present/result/described.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/json_reading.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::through;

namespace {

/// A verdict, or none: there is no usable model, or with one axis no antisymmetric part.
enum class Prediction { passive, active, undecided, none };

[[nodiscard]] constexpr auto word_table(Prediction) {
  using enum Prediction;
  return std::to_array<Word<Prediction>>(
      {{passive, "passive"}, {active, "active"}, {undecided, "undecided"}, {none, "none"}});
}

Prediction predicted(const std::optional<Verdict>& verdict) {
  return verdict ? value_of<Prediction>(word_of(*verdict)).value_or(Prediction::none) : Prediction::none;
}

std::pair<Hertz, Hertz> ends(const PassivityBand& band) {
  return {band.low, band.high};
}

}  // namespace

void describe(Fields<PassivityCondition>& fields) {
  fields.type("Condition", "A condition of passivity: it must be positive.");
  fields.add("name", &PassivityCondition::name);
  fields.add("source", &PassivityCondition::source, "publication");
  fields.add("unit", &PassivityCondition::unit);
  fields.add("value", &PassivityCondition::value);
  fields.add("standard_error", &PassivityCondition::standard_error);
  fields.add("lower", &PassivityCondition::lower, "lower limit: the value is above it with 97.5 % confidence");
  fields.add("upper", &PassivityCondition::upper,
             "upper limit: the value is below it with 97.5 % confidence for all conditions jointly");
  fields.add("verdict", &PassivityCondition::verdict);
}

void describe(Fields<ExcessOfPassivity>& fields) {
  fields.type("Excess", "Excess of passivity [unit of damping].");
  fields.add("corrected", &ExcessOfPassivity::corrected);
  fields.add("interval95", &ExcessOfPassivity::corrected95);
  fields.add("published_formula", &ExcessOfPassivity::published, "by the published formula, for comparison");
  fields.add("published_formula_interval95", &ExcessOfPassivity::published95);
}

void describe(Fields<PassivityIndexCurve>& fields) {
  fields.type("PassivityIndex", "Smallest damping over all directions of motion at each frequency [unit of damping].");
  fields.add("frequency_hz", &PassivityIndexCurve::frequency, "[Hz]");
  fields.add("value", &PassivityIndexCurve::index);
  fields.add("lower95", &PassivityIndexCurve::lower95);
  fields.add("upper95", &PassivityIndexCurve::upper95);
}

void describe(Fields<ModelPassivity>& fields) {
  using From = const ModelPassivity&;
  fields.type("ModelPassivity", "Passivity of the model by one method in a band.");
  fields.add("method", &ModelPassivity::method);
  fields.add("VAF", &ModelPassivity::vaf, "VAF of each axis, on held-out data if available [%]");
  fields.add("usable", &ModelPassivity::usable);
  fields.add("fits", &ModelPassivity::fits, "the model explains enough of the force for a prediction");
  fields.add("symmetric", &ModelPassivity::symmetric,
             "verdict on the symmetric parts, which do work in straight motion");
  fields.add(
      "antisymmetric", [](From model) { return predicted(model.antisymmetric); },
      "verdict on the antisymmetric parts, which do work in circular motion only; none with one axis");
  fields.add_choice("published_rule", &ModelPassivity::published_rule, "passive", "active",
                    "theorem 3.2 of Dyck (2013) as applied there: estimates without uncertainty, symmetric parts only");
  fields.add(
      "band_hz", [](From model) { return ends(model.band); }, "band of the verdict [Hz]");
  fields.add("band_rule", through(&ModelPassivity::band, &PassivityBand::rule), "how the band was chosen");
  fields.add("extrapolated", through(&ModelPassivity::band, &PassivityBand::extrapolated),
             "the band extends beyond `band_hz` of `passivity`");
  fields.add("min_index", &ModelPassivity::smallest_index, "smallest passivity index in the band");
  fields.add("min_index_interval95", &ModelPassivity::smallest_index95);
  fields.add("min_index_at_hz", &ModelPassivity::smallest_at, "[Hz]");
  fields.add_or_null("circular_hz", &ModelPassivity::circular_hz,
                     "frequencies between which the point estimate of the model absorbs energy in circular motion "
                     "[Hz]; high null: no upper limit; null: none, or one axis");
  fields.add("conditions", &ModelPassivity::conditions);
  fields.add("eop", &ModelPassivity::excess, "absent unless the symmetric parts of M and K are positive semidefinite");
  fields.add("index", &ModelPassivity::curve);
}

void describe(Fields<EnergyAccount>& fields) {
  fields.type("EnergyAccount", "Energy account of a recording.");
  fields.add("verdict", &EnergyAccount::verdict);
  fields.add("reason", &EnergyAccount::reason);
  fields.add("absorbed_J", &EnergyAccount::absorbed, "energy that the limb absorbed [J]");
  fields.add("interval95", &EnergyAccount::absorbed95, "[J]");
  fields.add("lower95_J", &EnergyAccount::lower95, "[J]");
  fields.add("upper95_J", &EnergyAccount::upper95, "[J]");
  fields.add("duration_s", &EnergyAccount::duration, "[s]");
  fields.add("mean_power_W", &EnergyAccount::mean_power, "[W]");
  fields.add("mean_power_interval95", &EnergyAccount::mean_power95, "[W]");
  fields.add("squared_velocity", &EnergyAccount::squared_velocity, "∫|v|² dt");
  fields.group("shortage", [](Fields<EnergyAccount>& part) {
    part.type("Shortage", "Shortage of passivity of the trial [unit of damping].");
    part.add("at_end", &EnergyAccount::shortage_at_end);
    part.add("at_end_interval95", &EnergyAccount::shortage_at_end95);
    part.add("largest", &EnergyAccount::shortage_largest);
    part.add("largest_interval95", &EnergyAccount::shortage_largest95);
  });
  fields.add("blocks", &EnergyAccount::blocks, "number of blocks used for the intervals");
}

void describe(Fields<EnergyLine>& fields) {
  fields.type("EnergyLine",
              "Energy that the limb absorbed at one line of a periodic perturbation, over whole periods.");
  fields.add("frequency_hz", &EnergyLine::frequency, "[Hz]");
  fields.add("duration_s", &EnergyLine::duration, "duration of those periods [s]");
  fields.add("absorbed_J", &EnergyLine::absorbed, "[J]");
  fields.add("interval95", &EnergyLine::absorbed95, "for all lines jointly [J]");
}

void describe(Fields<TrialPassivity>& fields) {
  const auto energy = &TrialPassivity::energy;
  fields.type("TrialPassivity", "What happened in the trial, by force and motion alone.");
  fields.add("verdict", through(energy, &EnergyAccount::verdict),
             "passive: `interval95` is above zero; active: it is below zero");
  fields.add("absorbed_J", through(energy, &EnergyAccount::absorbed), "energy that the limb absorbed [J]");
  fields.add("interval95", through(energy, &EnergyAccount::absorbed95), "[J]");
  fields.add("statement", &TrialPassivity::statement, "in words");
  fields.add("reason", through(energy, &EnergyAccount::reason), "reason for the verdict");
  fields.add_unless_empty("lines", &TrialPassivity::lines, "absent if the perturbation is not periodic");
}

void describe(Fields<PassivityPrediction>& fields) {
  using From = const PassivityPrediction&;
  fields.type("PassivityPrediction",
              "Prediction of the model for other motions. It is not a statement on the stability of a robot coupled to "
              "this person.");
  fields.add(
      "verdict", [](From prediction) { return predicted(prediction.verdict); },
      "verdict on both parts; none if the result is not usable; undecided if the model fits poorly, no reference was "
      "recorded or `band_hz` is null");
  fields.add(
      "symmetric", [](From prediction) { return predicted(prediction.symmetric); }, "straight motion");
  fields.add(
      "antisymmetric", [](From prediction) { return predicted(prediction.antisymmetric); }, "circular motion");
  fields.add("extrapolated", &PassivityPrediction::extrapolated, "the band extends beyond `band_hz`");
  fields.add("statement", &PassivityPrediction::statement, "in words");
}

void describe(Fields<Passivity>& fields) {
  using From = const Passivity&;
  const auto predicts = [](From passivity) { return passivity.prediction.verdict && !passivity.models.empty(); };
  fields.type("Passivity", "What happened in the trial, and what the model predicts: two statements.");
  fields.add("trial", &Passivity::trial, "absent if force or motion is not plausible");
  fields.add("prediction", &Passivity::prediction);
  fields.add_or_null(
      "band_hz", [](From passivity) { return passivity.band ? std::optional(ends(*passivity.band)) : std::nullopt; },
      "band in which all axes are excited with a coherence above 0.8 [Hz]; null: none");
  fields.add_if(
      predicts, "min_index", [](From passivity) { return passivity.models.front().smallest_index; },
      "of the first model, if it makes a prediction");
  fields.add_if(
      predicts, "eop", [](From passivity) { return passivity.models.front().excess; },
      "of the first model, if it makes a prediction");
  fields.add_unless_empty("models", &Passivity::models, "the model that makes the prediction comes first");
  fields.add(
      "energy", [](From passivity) { return passivity.trial ? &passivity.trial->energy : nullptr; },
      "energy account of `trial`");
}

void describe(Fields<EnergyPart>& fields) {
  fields.type("EnergyPart", "One perturbation, or one block.");
  fields.add_number("from_s", &EnergyPart::from_s, "[s]");
  fields.add_number("to_s", &EnergyPart::to_s, "[s]");
  fields.add("absorbed_J", &EnergyPart::absorbed, "[J]");
  fields.add("largest_displacement", &EnergyPart::largest_displacement, "[m or rad]");
  fields.add("path_length", &EnergyPart::path_length, "[m or rad]");
  fields.add("squared_velocity", &EnergyPart::squared_velocity, "∫|v|² dt");
  fields.add("shortage", &EnergyPart::shortage, "[unit of damping]");
}

void describe(Fields<Energy>& fields) {
  using From = const Energy&;
  fields.type("Energy", "Energy in one recording.");
  fields.add(
      "window_s",
      [](From energy) {
        return std::array{document::Number{energy.from_s}, document::Number{energy.to_s}};
      },
      "[s]");
  fields.add("account", &Energy::account);
  fields.add("shortage_largest_at_s", &Energy::shortage_largest_at_s, "[s]");
  fields.add("whole_recording_J", through(&Energy::curve, &EnergyCurve::end), "[J]");
  fields.add("time_s", through(&Energy::curve, &EnergyCurve::time), "[s]");
  fields.add("absorbed_J", through(&Energy::curve, &EnergyCurve::absorbed),
             "from the start of the window to that time [J]");
  fields.add_choice("parts_are", &Energy::parts_are_perturbations, "perturbations", "blocks");
  fields.add("parts", &Energy::parts);
  const auto curl = [](From energy) -> const CurlWork& { return *energy.curl; };
  const auto describe_curl = [curl](Fields<Energy>& part) {
    part.type("Curl", "Work of the antisymmetric (rotational) stiffness.");
    part.add("k_a", through(curl, &CurlWork::k_a), "[unit of stiffness]");
    part.add("absorbed_J", through(curl, &CurlWork::absorbed), "[J]");
    part.add("share", through(curl, &CurlWork::share), "share of the total energy");
    part.add("over_time_J", through(&Energy::curve, &EnergyCurve::curl), "[J]");
  };
  fields.group("curl", describe_curl).only_if([](From energy) { return energy.curl.has_value(); });
}

namespace result {

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

void describe(Fields<PassivityDocument>& fields) {
  fields.type("PassivityDocument", "Output of `mbk passivity --json` for one recording or result.");
  fields.header("mbk.passivity/2");
  fields.add("inputs", &PassivityDocument::inputs);
  fields.add("passivity", &PassivityDocument::passivity);
  fields.add("recordings", &PassivityDocument::recordings, "one for each recording; none for a stored result");
}

void describe(Fields<document::List<PassivityDocument>>& fields) {
  describe_list(fields, "PassivityDocuments", "mbk.passivities/1",
                "Output of `mbk passivity --json` for several recordings or results.");
}

std::string to_json(std::span<const PassivityDocument> all) {
  return document::one_or_list(all);
}

void add_passivity_schemas(document::Schemas& schemas) {
  schemas["passivity"] = document::schema_of<PassivityDocument>();
  schemas["passivities"] = document::schema_of<document::List<PassivityDocument>>();
}

}  // namespace result
}  // namespace mbk
