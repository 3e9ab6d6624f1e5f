#include "mbk/present/result/teleoperation_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mbk/model/trial/identification.h"
#include "mbk/present/result/json_reading.h"

namespace mbk::result {
namespace {

Json stability_json(const AbsoluteStability& stability) {
  Json json = {{"form", stability.form},
               {"verdict", word_of(stability.verdict)},
               {"absolutely_stable", stability.holds()},
               {"conditions", Json::array()}};
  for (const StabilityOutcome& outcome : stability.conditions) {
    Json one = {{"name", word_of(outcome.condition)},
                {"condition", text(outcome.condition)},
                {"holds", outcome.violated.empty()},
                {"violated", Json::array()}};
    for (const ViolatedBand& band : outcome.violated) {
      Json where = {{"from", number(band.low.value)}, {"to", number(band.high.value)}};
      if (band.detail.empty()) {
        where["worst"] = number(band.worst.value);
        where["value"] = number(band.value);
      } else {
        where["pole"] = band.detail;
      }
      one["violated"].push_back(std::move(where));
    }
    json["conditions"].push_back(std::move(one));
  }
  if (stability.verdict == StabilityVerdict::marginal) {
    json["equality_at"] = Json::array();
    for (const RadPerSec omega : stability.touches) json["equality_at"].push_back(number(omega.value));
    json["equality_everywhere"] = stability.touches_everywhere;
  }
  return json;
}

Json end_json(const AdmissibleEnd& end) {
  return {{"value", number(end.value)},
          {"included", end.included ? Json(*end.included) : Json(nullptr)},
          {"end_of_range", end.limit_of_search}};
}

Json admissible_json(const AdmissibleSet& set) {
  Json json = {
      {"parameter", set.parameter}, {"unit", set.unit},           {"range", {number(set.low), number(set.high)}},
      {"intervals", Json::array()}, {"undecided", set.undecided}, {"critical", set.critical}};
  for (const AdmissibleInterval& interval : set.intervals) {
    json["intervals"].push_back({{"low", end_json(interval.low)}, {"high", end_json(interval.high)}});
  }
  return json;
}

Json curve_json(const Chart& chart) {
  Json x = Json::array(), y = Json::array();
  for (const double value : chart.series.front().x) x.push_back(number(value));
  for (const double value : chart.series.front().y) y.push_back(number(value));
  return {{"name", chart.series.front().name}, {"frequency", std::move(x)}, {"value", std::move(y)}};
}

Json termination_json(const Termination& termination) {
  return {{"mass", number(termination.mass)},
          {"damping", number(termination.damping)},
          {"stiffness", number(termination.stiffness)}};
}

Json run_json(const TeleoperationRun& run) {
  Json json = {{"what", run.what},
               {"hand", run.hand},
               {"environment", run.environment},
               {"outcome", word_of(run.outcome)},
               {"ratio", number(run.ratio)},
               {"frequency", number(run.frequency.value)},
               {"duration", number(run.duration)},
               {"ran_away", run.ran_away},
               {"largest_position", number(run.largest_position)},
               {"packets", run.sent},
               {"packets_lost", run.lost}};
  if (run.lowest_energy) json["lowest_energy"] = number(*run.lowest_energy);
  if (run.worst) {
    json["expected"] = {{"frequency", number(run.worst->frequency.value)},
                        {"growth", number(run.worst->growth)},
                        {"hand", termination_json(run.worst->at_port[0])},
                        {"environment", termination_json(run.worst->at_port[1])}};
  }
  return json;
}

Json simulation_json(const TeleoperationSimulation& simulation) {
  Json json = {
      {"sample_time", number(simulation.sample_time)},
      {"grid",
       {{"from", simulation.grid.low.value}, {"to", simulation.grid.high.value}, {"points", simulation.grid.points}}},
      {"runs", Json::array()},
      {"notes", simulation.notes}};
  if (simulation.sampled) json["llewellyn"] = stability_json(*simulation.sampled);
  if (simulation.sampled_with_operator) json["modified_llewellyn"] = stability_json(*simulation.sampled_with_operator);
  for (const TeleoperationRun& run : simulation.runs) json["runs"].push_back(run_json(run));
  return json;
}

Json excess_json(const ExcessSweep& sweep) {
  Json json = {{"parameter", sweep.parameter},
               {"unit", sweep.unit},
               {"frequency", number(sweep.frequency.value)},
               {"steps", Json::array()}};
  for (const ExcessStep& step : sweep.steps) {
    Json one = {{"excess", number(step.excess)}, {"admissible", admissible_json(step.set)}};
    if (step.felt) one["felt"] = {{"free", number(step.felt->free)}, {"clamped", number(step.felt->clamped)}};
    json["steps"].push_back(std::move(one));
  }
  return json;
}

/// The lowest of the numbers of a list at that place; absent where one is none.
std::optional<double> lowest_at(const Json& json, const char* place) {
  const Json::json_pointer at(place);
  if (!json.contains(at) || !json[at].is_array() || json[at].empty()) return std::nullopt;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Json& one : json[at]) {
    if (!one.is_number()) return std::nullopt;
    lowest = std::min(lowest, one.get<double>());
  }
  return lowest;
}

/// Why the model of a document cannot stand for an operator; empty where it can.
std::string unfit(const Json& json) {
  const auto is = [&](const char* place, const Json& value) {
    const Json::json_pointer at(place);
    return json.contains(at) && json[at] == value;
  };
  if (is("/usable", false) || is("/passivity/prediction/verdict", "none") || is("/passivity/models/0/usable", false)) {
    return "the result is not usable";
  }
  const auto warnings = json.find("warnings");
  const bool warned =
      warnings != json.end() && warnings->is_array() && std::ranges::any_of(*warnings, [](const Json& one) {
        const auto word = one.is_object() ? one.value("code", Json()) : Json();
        if (!word.is_string()) return false;
        const auto code = value_of<WarningCode>(word.get<std::string>());
        return code == WarningCode::fit_poor || code == WarningCode::held_out_fit_poor;
      });
  if (warned || is("/passivity/models/0/fits", false) || is("/passivity/decided_by", "energy")) {
    return "its model explains too little of the force";
  }
  if (is("/passivity/band_hz", nullptr)) return "at no two frequencies does it show how the arm answers in all axes";
  return "";
}

/// Whether a result or what decides its passivity has a unit of rotation.
bool is_of_rotation(const Json& json) {
  const std::string rotation = units_of(Motion::rotation).damping;
  const Json::json_pointer damping("/units/B"), conditions("/passivity/models/0/conditions");
  if (json.contains(damping)) return json[damping] == rotation;
  if (!json.contains(conditions) || !json[conditions].is_array()) return false;
  return std::ranges::any_of(json[conditions],
                             [&](const Json& one) { return one.is_object() && one.value("unit", Json()) == rotation; });
}

}  // namespace

std::string to_json(const TeleoperationFinding& finding) {
  Json json = header("mbk.teleop/1");
  json["inputs"] = Json::array({{{"file", finding.file}}});
  json["name"] = finding.name;
  json["kind"] = finding.kind;
  json["parameters"] = Json::object();
  for (const DesignParameter& p : finding.parameters) json["parameters"][p.name] = number(p.value);
  json["decided"] = finding.grid ? "on the grid" : "exactly";
  if (finding.grid) {
    json["grid"] = {
        {"from", finding.grid->low.value}, {"to", finding.grid->high.value}, {"points", finding.grid->points}};
  }
  json["llewellyn"] = stability_json(finding.stability);
  if (finding.with_operator) {
    json["operator"] = {{"port", finding.operator_port},
                        {"a", number(finding.operator_shortage->a)},
                        {"rule", finding.operator_shortage->rule}};
    json["modified_llewellyn"] = stability_json(*finding.with_operator);
  }
  json["largest_a"] = Json::array();
  for (const LargestShortage& largest : finding.largest_shortages) {
    Json one = {{"port", largest.port}, {"a", largest.exists ? number(largest.value()) : Json(nullptr)}};
    if (largest.exists) {
      one["at_least"] = number(largest.at_least);
      one["at_most"] = number(largest.at_most);
    }
    json["largest_a"].push_back(std::move(one));
  }
  if (finding.admissible) json["admissible"] = admissible_json(*finding.admissible);
  if (finding.excess) json["excess"] = excess_json(*finding.excess);
  if (finding.simulation) json["simulation"] = simulation_json(*finding.simulation);
  json["curves"] = Json::array();
  for (const Chart& chart : finding.charts) json["curves"].push_back(curve_json(chart));
  json["notes"] = finding.notes;
  return dumped(json);
}

Result<OperatorShortage> operator_shortage_from_json(std::string_view text) {
  const char* const remedy = "give a file that 'mbk measure --json' or 'mbk passivity --json' wrote";
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    return bad_data(fmt::format("not JSON: byte {} cannot be there", error.byte), remedy);
  }
  if (has_schema(json, "mbk.results/1") || has_schema(json, "mbk.passivities/1")) {
    const auto results = json.find("results");
    if (results == json.end() || !results->is_array() || results->size() != 1) {
      return bad_data("it holds several results or none", "give a file with the result of one operator");
    }
    json = Json((*results)[0]);
  }
  const auto schemas = {"mbk.result/2", "mbk.passivity/2", "mbk.result/1", "mbk.passivity/1"};
  if (std::ranges::none_of(schemas, [&](const char* one) { return has_schema(json, one); })) {
    return bad_data("no result of mbk: its schema is neither mbk.result/2 nor mbk.passivity/2", remedy);
  }
  if (is_of_rotation(json)) {
    return bad_data("it is of a joint that turns: its excess of passivity is in N·m·s/rad, and a design is in N·s/m",
                    "give the result of an arm that was moved along a line or in a plane");
  }
  if (const std::string why = unfit(json); !why.empty()) {
    return tl::unexpected(Error{ErrorKind::not_usable, why + ", so that nothing follows from it for a design",
                                "measure again; see what 'mbk measure' warns of, and its --report", ""});
  }
  const auto low = lowest_at(json, "/passivity/models/0/index/lower95"),
             high = lowest_at(json, "/passivity/models/0/index/upper95"),
             from = lowest_at(json, "/passivity/models/0/index/frequency_hz");
  const Json::json_pointer band("/passivity/models/0/band_hz");
  if (!low || !high || !from || !json.contains(band) || !json[band].is_array() || json[band].size() != 2 ||
      !json[band][1].is_number()) {
    return bad_data("it says nothing of how passive the operator is",
                    "measure with 'mbk measure --json', which writes the passivity index, or give shortage_N_s_per_m");
  }
  const bool extrapolated = json.value(Json::json_pointer("/passivity/models/0/extrapolated"), false);
  return OperatorShortage{
      0.0 - *low,
      fmt::format("minus the lower end of the 95 % interval of the smallest passivity index, {:.4g} to {:.4g} N·s/m, "
                  "from {:.3g} to {:.3g} Hz, antisymmetric part included; {} is an assumption",
                  *low, *high, *from, json[band][1].get<double>(),
                  extrapolated ? "what lies beyond the data, in that band and outside it,"
                               : "that it is no worse outside that band"),
      std::pair{*low, *high}};
}

}  // namespace mbk::result
