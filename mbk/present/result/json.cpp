#include "mbk/present/result/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/model.h"
#include "mbk/present/result/findings_json.h"
#include "mbk/present/result/force_comparison_json.h"
#include "mbk/present/result/joint_domain_json.h"
#include "mbk/present/result/json_parts.h"
#include "mbk/present/result/json_reading.h"
#include "mbk/present/result/passivity_json.h"

namespace mbk::result {
namespace {

constexpr const char* kResultSchema = "mbk.result/2";
constexpr const char* kFirstResultSchema = "mbk.result/1";  ///< still read
constexpr const char* kResultsSchema = "mbk.results/1";

Json model_json(const impedance::Model& model) {
  return {{"M", rows(model.M)}, {"B", rows(model.B)}, {"K", rows(model.K)}, {"x0", list(model.x0)}};
}

Json numbers(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(number(value));
  return array;
}

Json chart_json(const Chart& chart) {
  Json json = {{"title", chart.title},
               {"x", {{"label", chart.x.label}, {"unit", chart.x.unit}}},
               {"y", {{"label", chart.y.label}, {"unit", chart.y.unit}}},
               {"series", Json::array()}};
  for (const ChartSeries& series : chart.series) {
    Json one = {{"name", series.name}, {"x", numbers(series.x)}, {"y", numbers(series.y)}};
    for (const auto& ends : series.intervals) one["intervals"].push_back(interval(ends));
    json["series"].push_back(std::move(one));
  }
  if (!chart.horizontal.empty()) json["horizontal"] = references_json(chart.horizontal);
  if (!chart.vertical.empty()) json["vertical"] = references_json(chart.vertical);
  if (chart.identity) json["identity"] = true;
  if (!chart.notes.empty()) json["notes"] = chart.notes;
  return json;
}

Json ellipses_json(const Findings& findings) {
  Json json = Json::object();
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) json[kMatrixNames[k]] = ellipse_json(findings.ellipses[k]);
  return json;
}

Json antisymmetries_json(const Findings& findings) {
  return {{"inertia", antisymmetry_json(findings.antisymmetry[0])},
          {"stiffness", antisymmetry_json(findings.antisymmetry[1])}};
}

Json fit_json(const Fit& fit) {
  return {{"VAF", list(fit.vaf)},
          {"RMSE", list(fit.rmse)},
          {"validated_on", validated_on(fit.held_out)},
          {"VAF_in_sample", list(fit.vaf_in_sample)}};
}

Json instrument_json(const InstrumentCheck& check) {
  return {{"reference", word_of(check.from)},
          {"first_stage_F", list(check.strength)},
          {"weakest_F", number(check.weakest())},
          {"strong", check.strong()},
          {"coherent_residual_fraction", list(check.coherent_residual)}};
}

Json unmodelled_json(const UnmodelledResponse& response) {
  Json json = {{"coherent_share", list(response.coherent)}};
  if (response.induced.size() > 0) json["induced_share"] = list(response.induced);
  return json;
}

Json assumptions_json(const std::vector<AssumptionTest>& tests) {
  Json json = Json::array();
  for (const AssumptionTest& test : tests) {
    json.push_back({{"assumption", word_of(test.assumption)},
                    {"contradicted", test.contradicted},
                    {"p_value", number(test.p_value)},
                    {"size", number(test.size)},
                    {"shift", number(test.shift)}});
    if (test.frequency_hz > 0.0) json.back()["frequency_hz"] = number(test.frequency_hz);
  }
  return json;
}

/// A second method beside the first, without what both have in common.
Json alternative_json(const Identification& id) {
  Json json = {{"method", word_of(id.method)},
               {"model", model_json(id.model)},
               {"standard_error", model_json(id.standard_error)},
               {"fit", fit_json(id.fit)},
               {"covariance", {{"parameters", id.parameters}, {"matrix", rows(id.covariance)}}},
               {"warnings", warnings_json(id.warnings)},
               {"usable", id.usable}};
  if (id.instrument) json["instrument"] = instrument_json(*id.instrument);
  if (id.response) json["unmodelled_response"] = unmodelled_json(*id.response);
  return json;
}

Json bootstrap_json(const BootstrapFindings& bootstrap) {
  Json json = {{"replicates", bootstrap.replicates},
               {"block_s", bootstrap.block_s},
               {"blocks", number(bootstrap.blocks)},
               {"seed", bootstrap.seed},
               {"quantities", Json::array()}};
  for (const BootstrapFinding& finding : bootstrap.findings) {
    json["quantities"].push_back({{"name", finding.name},
                                  {"unit", finding.unit},
                                  {"value", number(finding.value)},
                                  {"interval95", interval(finding.interval95)},
                                  {"delta_interval95", interval(finding.delta95)}});
  }
  return json;
}

Json consistent_json(const ConsistentFit& fit) {
  const auto cone = [](const Semidefiniteness& one) {
    return Json{{"free_smallest_eigenvalue", number(one.free_smallest)},
                {"smallest_eigenvalue", number(one.smallest)},
                {"active", one.active}};
  };
  return {
      {"model", model_json(fit.model)},
      {"inertia", cone(fit.inertia)},
      {"damping", cone(fit.damping)},
      {"stiffness", cone(fit.stiffness)},
      {"fit", fit_json(fit.fit)},
      {"residual_power_increase_percent", number(fit.increase_percent())},
      {"force_change", number(fit.force_change)},
      {"largest_change", {{"parameter", fit.largest_change}, {"standard_errors", number(fit.largest_change_errors)}}},
      {"duality_gap", number(fit.duality_gap)}};
}

Json disagreement_json(const Disagreement& disagreement) {
  return {{"parameter", disagreement.parameter},
          {"least_squares", number(disagreement.least_squares)},
          {"iv_less_ls", number(disagreement.difference)},
          {"standard_error", number(disagreement.standard_error)},
          {"significant", disagreement.significant}};
}

/// What a force sensor gives, and what the computed force makes of it instead.
Json by_sensor_json(const Identification& computed, const Identification& sensed) {
  const impedance::Model &a = computed.model, &b = sensed.model;
  return {{"model", model_json(b)},
          {"standard_error", model_json(sensed.standard_error)},
          {"fit", fit_json(sensed.fit)},
          {"induced_error", model_json({a.M - b.M, a.B - b.B, a.K - b.K, a.x0 - b.x0})}};
}

Json result_json(const Measurement& measured) {
  const Identification& id = measured.identification;
  Json json = header(kResultSchema);
  json["inputs"] = inputs_json(id.sources);
  for (std::size_t i = 0; i < id.sources.size(); ++i) {
    json["inputs"][i]["duration_s"] = id.durations[i];
    json["inputs"][i]["rate_hz"] = id.rates[i];
  }
  if (!id.notes.empty()) json["notes"] = id.notes;
  if (!id.preparations.empty()) {  // a result that was read back says nothing of how it was made
    json["mode"] = word_of(id.preparations.front().mode);
    json["protocol"] = word_of(id.preparations.front().protocol);
  }
  json["method"] = word_of(id.method);
  if (!id.method_rule.empty()) json["method_rule"] = id.method_rule;
  json["axes"] = id.axes;
  json["structure"] = word_of(id.structure);
  if (id.motion != Motion::unknown) {
    json["units"] = units_json(id.motion);
  }
  json["model"] = model_json(id.model);
  json["standard_error"] = model_json(id.standard_error);
  if (id.standard_error_of_robot) json["standard_error_of_robot"] = model_json(*id.standard_error_of_robot);
  json["fit"] = fit_json(id.fit);
  if (measured.findings) {
    json["ellipses"] = ellipses_json(*measured.findings);
    json["antisymmetry"] = antisymmetries_json(*measured.findings);
  }
  if (measured.joints) json["joint_domain"] = joint_domain_json(*measured.joints);
  if (id.instrument) json["instrument"] = instrument_json(*id.instrument);
  if (id.response) json["unmodelled_response"] = unmodelled_json(*id.response);
  json["assumptions"] = assumptions_json(id.assumptions);
  json["sensitivity"] = {{"x0_per_force", rows(numeric::inverse(id.model.K))}, {"B_per_delay", rows(-id.model.K)}};
  json["alternatives"] = Json::array();
  if (measured.alternative) json["alternatives"].push_back(alternative_json(*measured.alternative));
  json["disagreement"] = measured.disagreement ? disagreement_json(*measured.disagreement) : Json(nullptr);
  if (measured.force_comparison) json["force_comparison"] = force_comparison_json(*measured.force_comparison);
  if (measured.by_sensor) json["by_force_sensor"] = by_sensor_json(id, *measured.by_sensor);
  if (measured.bootstrap) json["bootstrap"] = bootstrap_json(*measured.bootstrap);
  if (measured.consistent) json["consistent_fit"] = consistent_json(*measured.consistent);
  if (measured.passivity) json["passivity"] = passivity_json(*measured.passivity);
  json["warnings"] = warnings_json(id.warnings);
  json["usable"] = id.usable;
  json["covariance"] = {{"parameters", id.parameters}, {"matrix", rows(id.covariance)}};
  json["estimation"] = {{"parameters_from", id.parameters_from ? word_of(*id.parameters_from) : ""},
                        {"samples", id.samples},
                        {"duration_s", id.excitation.duration},
                        {"hac_lag_s", id.hac_lag_s},
                        {"handle_mass_kg", id.handle_mass},
                        {"handle_mass_from", word_of(id.handle_mass_from)}};
  json["excitation"] = {{"rank", id.excitation.rank},
                        {"condition", number(id.excitation.condition)},
                        {"motion_ratio", number(id.excitation.motion_ratio)},
                        {"motion", number(id.excitation.motion)},
                        {"inertia_share", number(id.excitation.inertia_share)}};
  if (id.decimation) {
    json["decimate_check"] = {{"rate_hz", id.decimation->rate_hz},
                              {"model", model_json(id.decimation->model)},
                              {"largest_relative_change", id.decimation->largest_change}};
  }
  json["preparation"] = Json::array();
  for (const Preparation& one : id.preparations) json["preparation"].push_back(preparation_json(one));
  return json;
}

Json info_json(const Recording& recording, const Inspection& inspection) {
  Json json = header("mbk.info/1");
  json["inputs"] = inputs_json(recording.sources);
  json["samples"] = inspection.samples;
  json["duration_s"] = number(inspection.duration);
  json["rate_hz"] = number(inspection.rate_hz);
  json["interval_s"] = {{"minimum", number(inspection.interval_min)},
                        {"median", number(inspection.interval_median)},
                        {"maximum", number(inspection.interval_max)},
                        {"standard_deviation", number(inspection.interval_standard_deviation)}};
  json["gaps"] = Json::array();
  for (const Gap& gap : inspection.gaps) {
    json["gaps"].push_back(
        {{"after_sample", gap.sample + 1}, {"time_s", number(gap.time)}, {"length_s", number(gap.length)}});
  }
  json["duplicated_times"] = inspection.duplicated_times;
  json["backward_times"] = inspection.backward_times;
  json["non_finite"] = Json::array();
  for (const NonFinite& bad : inspection.non_finite) {
    json["non_finite"].push_back({{"channel", bad.channel}, {"count", bad.count}, {"first_sample", bad.first + 1}});
  }
  json["missing"] = Json::array();
  for (const MissingSamples& missing : inspection.missing) {
    json["missing"].push_back(
        {{"first_sample", missing.first + 1}, {"count", missing.count}, {"time_s", number(missing.time)}});
  }
  json["channels"] = Json::array();
  for (const ChannelFacts& facts : inspection.channels) {
    json["channels"].push_back({{"name", facts.name},
                                {"unit", facts.unit},
                                {"minimum", number(facts.min)},
                                {"maximum", number(facts.max)},
                                {"constant", facts.constant},
                                {"clipped", facts.clipped},
                                {"update_hz", number(facts.update_hz)}});
    if (facts.updates.staleness == Staleness::none) continue;
    json["channels"].back()["stale"] = {{"kind", word_of(facts.updates.staleness)},
                                        {"share", number(facts.updates.share)}};
  }
  json["events"] = Json::array();
  for (const Event& event : recording.events) {
    json["events"].push_back({{"time_s", number(event.time)}, {"name", event.name}, {"value", number(event.value)}});
  }
  json["metadata"] = Json::object();
  for (const auto& [key, value] : recording.metadata) json["metadata"][key] = value;
  json["notes"] = recording.notes;
  return json;
}

/// A document with its elements in the place of an empty list, as dumped() would write all of it: so no more than one
/// element is there as a tree, which takes several times the memory of its text.
/// @param document  dumped, with an empty list of that name on its first level
template <class Element>
std::string with_elements(const std::string& document, const std::string& name, std::size_t count,
                          const Element& element) {
  const std::string empty = fmt::format("\n  \"{}\": []", name);  // within a string there is no line end
  const std::size_t place = document.find(empty);
  if (count == 0 || place == std::string::npos) return document;
  std::string text = document.substr(0, place + empty.size() - 1);
  for (std::size_t k = 0; k < count; ++k) {
    text += k > 0 ? ",\n    " : "\n    ";
    std::string one = dumped(element(k));
    one.pop_back();  // its line end
    for (std::size_t begin = 0; begin < one.size();) {
      const std::size_t end = std::min(one.find('\n', begin), one.size() - 1) + 1;
      text.append(one, begin, end - begin);
      if (end < one.size()) text += "    ";
      begin = end;
    }
  }
  text += "\n  ";
  text.append(document, place + empty.size() - 1);
  return text;
}

/// One document whatever their number: the only object itself, or all of them as `results` of another schema.
std::string one_or_list(const char* schema_of_list, const std::vector<Json>& objects) {
  if (objects.size() == 1) return dumped(objects.front());
  Json json = header(schema_of_list);
  json["results"] = objects;
  return dumped(json);
}

// Reading back. Every access is checked; nlohmann's exceptions stay inside `identifications_from_json`.

impedance::Model model_from(const Json& json, const char* name, Index n) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_object()) throw Malformed{fmt::format("'{}' is missing", name)};
  return {matrix_from(*found, "M", n, n), matrix_from(*found, "B", n, n), matrix_from(*found, "K", n, n),
          found->contains("x0") ? Vector(matrix_from(*found, "x0", n, 1)) : Vector::Constant(n, kNaN)};
}

Fit fit_from(const Json& json, Index n) {
  Fit fit;
  fit.vaf = list_from(json, "VAF", n);
  fit.rmse = list_from(json, "RMSE", n);
  fit.vaf_in_sample = json.contains("VAF_in_sample") ? list_from(json, "VAF_in_sample", n) : Vector::Constant(n, kNaN);
  const std::string on = json.value("validated_on", validated_on(true));
  fit.held_out = on == validated_on(true) || on == "held-back";  // so until the version before
  return fit;
}

std::vector<Warning> warnings_from(const Json& json) {
  if (!json.is_array()) throw Malformed{"'warnings' is not a list"};
  std::vector<Warning> warnings;
  for (const Json& one : json) {
    const std::string code = one.value("code", "");
    const auto known = value_of<WarningCode>(code);
    if (!known) throw Malformed{fmt::format("there is no warning '{}'", code)};
    warnings.push_back({*known, one.value("message", ""), one.value("try", ""), one.value("was", "")});
  }
  return warnings;
}

Motion motion_from(const Json& json) {
  const auto units = json.find("units");
  if (units == json.end()) return Motion::unknown;
  const std::string inertia = units->value("M", "");
  for (const Motion motion : {Motion::translation, Motion::rotation}) {
    if (inertia == units_of(motion).inertia) return motion;
  }
  return Motion::unknown;
}

/// What both methods' results have: model, covariance, fit, method, instruments, warnings, usable.
Identification estimate_from(const Json& json, Index n) {
  Identification id;
  id.axes = static_cast<int>(n);
  const Index count = 3 * n * n + n;
  id.model = model_from(json, "model", n);
  id.covariance = Matrix::Constant(count, count, kNaN);
  const Matrix none = Matrix::Constant(n, n, kNaN);
  id.standard_error = {none, none, none, Vector::Constant(n, kNaN)};
  if (json.contains("standard_error")) {
    id.standard_error = model_from(json, "standard_error", n);
    id.covariance = impedance::stacked(id.standard_error).cwiseAbs2().asDiagonal();
  }
  if (const auto covariance = json.find("covariance"); covariance != json.end() && covariance->is_object()) {
    id.covariance = matrix_from(*covariance, "matrix", count, count);
    id.parameters = covariance->value("parameters", std::vector<std::string>{});
  }
  id.method = value_of<Method>(json.value("method", "")).value_or(Method::least_squares);
  id.structure = value_of<Structure>(json.value("structure", "")).value_or(Structure::full);
  id.usable = json.value("usable", true);
  const Vector unknown = Vector::Constant(n, kNaN);
  id.fit = json.contains("fit") ? fit_from(json["fit"], n) : Fit{unknown, unknown, unknown, false};
  if (json.contains("warnings")) id.warnings = warnings_from(json["warnings"]);
  if (const auto found = json.find("instrument"); found != json.end() && found->is_object()) {
    InstrumentCheck check;
    check.from = value_of<ReferenceQuantity>(found->value("reference", "")).value_or(ReferenceQuantity::unknown);
    check.strength = list_from(*found, "first_stage_F", 3 * n);
    const char* const former = "answered_share";  // so until the version before
    check.coherent_residual = list_from(*found, found->contains(former) ? former : "coherent_residual_fraction", n);
    id.instrument = std::move(check);
  }
  return id;
}

Index axes_of(const Json& json) {
  const auto model = json.find("model");
  const bool one_axis = model != json.end() && model->is_object() && model->contains("M") && (*model)["M"].is_array() &&
                        (*model)["M"].size() == 1;
  return one_axis ? 1 : 2;
}

Identification identification_from(const Json& json) {
  if (!has_schema(json, kResultSchema) && !has_schema(json, kFirstResultSchema)) {
    throw Malformed{fmt::format("this is not a result of mbk (schema '{}' was expected)", kResultSchema)};
  }
  Identification id = estimate_from(json, axes_of(json));
  if (const auto inputs = json.find("inputs"); inputs != json.end() && inputs->is_array()) {
    for (const Json& input : *inputs) {
      id.sources.push_back(
          {input.value("file", ""), input.value("format", ""), input.value("sha256", ""), input.value("trial", "")});
      id.durations.push_back(input.contains("duration_s") ? number_from(input["duration_s"]) : kNaN);
      id.rates.push_back(input.contains("rate_hz") ? number_from(input["rate_hz"]) : kNaN);
    }
  }
  id.motion = motion_from(json);
  if (const auto notes = json.find("notes"); notes != json.end()) id.notes = notes->get<std::vector<std::string>>();
  return id;
}

}  // namespace

std::string to_json(const Measurement& measured) {
  return dumped(result_json(measured));
}

std::string to_compact_json(const Measurement& measured) {
  return result_json(measured).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const std::vector<Measurement>& results, const SeveralTrials& together) {
  Json json = header(kResultsSchema);
  json["results"] = Json::array();
  if (const auto& summary = together.summary) {
    Json omitted = Json::array();
    for (const OmittedTrial& one : summary->omitted) omitted.push_back({{"file", one.file}, {"why", one.why}});
    json["summary"] = {{"trials", summary->trials},
                       {"omitted", std::move(omitted)},
                       {"method", word_of(summary->method)},
                       {"model", model_json(summary->mean)},
                       {"between_trial_standard_error", model_json(summary->between_trial_standard_error)},
                       {"half_width95", model_json(summary->half_width95)}};
  } else {
    json["no_summary"] = together.no_summary;
  }
  if (!together.failed.empty()) {
    json["failed"] = Json::array();
    for (const Error& error : together.failed) {
      json["failed"].push_back({{"file", error.where}, {"message", error.message}, {"try", error.remedy}});
    }
  }
  return with_elements(dumped(json), "results", results.size(), [&](std::size_t k) { return result_json(results[k]); });
}

std::string to_json(const std::vector<Identification>& identifications, const std::vector<Findings>& findings) {
  std::vector<Json> objects;
  for (std::size_t i = 0; i < findings.size(); ++i) {
    Json json = header("mbk.ellipse/1");
    json["inputs"] = inputs_json(identifications[i].sources);
    json["ellipses"] = ellipses_json(findings[i]);
    json["antisymmetry"] = antisymmetries_json(findings[i]);
    objects.push_back(std::move(json));
  }
  return one_or_list("mbk.ellipses/1", objects);
}

std::string to_json(const std::vector<Recording>& recordings, const std::vector<Inspection>& inspections) {
  std::vector<Json> objects;
  for (std::size_t i = 0; i < inspections.size(); ++i) objects.push_back(info_json(recordings[i], inspections[i]));
  return one_or_list("mbk.infos/1", objects);
}

std::string to_json(const FileContents& contents, const Error& unrecognised) {
  Json json = header("mbk.contents/1");
  json["inputs"] = inputs_json({contents.source});
  json["kind"] = contents.table ? "table" : "variables";
  json["arrays"] = Json::array();
  for (const StoredArray& array : contents.arrays) {
    Json one = {{"name", array.name},
                {"rows", array.rows},
                {"columns", array.columns},
                {"minimum", number(array.minimum)},
                {"maximum", number(array.maximum)}};
    if (!array.unit.empty()) one["unit"] = array.unit;
    if (array.rate_hz > 0) one["rate_hz"] = array.rate_hz;
    if (!array.shape.empty()) one["shape"] = array.shape;
    json["arrays"].push_back(std::move(one));
  }
  json["notes"] = contents.notes;
  json["unrecognised"] = {{"message", unrecognised.message}, {"try", unrecognised.remedy}};
  return dumped(json);
}

std::string to_json(const ValidationTable& table) {
  Json json = header("mbk.validation/2");
  json["study"] = table.study;
  json["question"] = table.question;
  json["unit"] = table.unit;
  json["runs"] = table.runs;
  json["seed"] = table.seed;
  json["rows"] = Json::array();
  for (const ValidationRow& row : table.rows) {
    Json one = {{"what", row.what},
                {"value", number(row.value)},
                {"interval95", row.interval95 ? interval(*row.interval95) : Json(nullptr)},
                {"expected", row.expected ? interval(*row.expected) : Json(nullptr)},
                {"verdict", word_of(row.verdict())},
                {"met", row.judged() ? Json(row.met()) : Json(nullptr)}};
    if (row.unit) one["unit"] = *row.unit;
    if (row.spread) one["spread"] = number(*row.spread);
    if (row.trials) one["trials"] = *row.trials;
    json["rows"].push_back(std::move(one));
  }
  json["verdict"] = word_of(table.verdict());
  json["met"] = table.met();
  if (!table.notes.empty()) json["notes"] = table.notes;
  for (const Chart& chart : table.charts) json["charts"].push_back(chart_json(chart));
  return dumped(json);
}

std::string one_or_list_json(const char* schema_of_list, const std::vector<std::string>& documents) {
  std::vector<Json> objects;
  for (const std::string& document : documents) objects.push_back(Json::parse(document));
  return one_or_list(schema_of_list, objects);
}

namespace {

/// Every result of a document by itself, read by `read`.
template <class Read>
auto each_result(std::string_view text, Read read) -> Result<std::vector<decltype(read(Json()))>> {
  const char* const remedy = "give a file that 'mbk measure --json' or 'mbk identify --json' wrote";
  try {
    const Json json = Json::parse(text);
    std::vector<decltype(read(Json()))> all;
    if (has_schema(json, kResultsSchema)) {
      const auto results = json.find("results");
      if (results == json.end() || !results->is_array() || results->empty()) {
        throw Malformed{"'results' holds no result"};
      }
      for (const Json& one : *results) all.push_back(read(one));
    } else {
      all.push_back(read(json));
    }
    return all;
  } catch (const Malformed& malformed) {
    return bad_data(malformed.message, remedy);
  } catch (const nlohmann::json::parse_error& error) {
    return bad_data(fmt::format("not valid JSON, byte {}", error.byte), remedy);
  } catch (const nlohmann::json::exception& error) {
    return bad_data(fmt::format("not a result of mbk ({})", error.what()), remedy);
  }
}

}  // namespace

Result<std::vector<Identification>> identifications_from_json(std::string_view text) {
  return each_result(text, identification_from);
}

Result<std::vector<StoredResult>> results_from_json(std::string_view text) {
  return each_result(text, [](const Json& json) {
    StoredResult result{identification_from(json), std::nullopt, {}};
    const auto others = json.find("alternatives");
    if (others != json.end() && others->is_array() && !others->empty()) {
      result.alternative = estimate_from(others->front(), axes_of(json));
    }
    if (const auto found = json.find("passivity"); found != json.end() && found->is_object()) {
      result.passivity = stored_passivity_from(*found);
    }
    return result;
  });
}

}  // namespace mbk::result
