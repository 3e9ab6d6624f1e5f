#include "mbk/present/result/json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "mbk/model/impedance/model.h"
#include "mbk/present/result/json_reading.h"
#include "mbk/present/result/passivity_json.h"
#include "mbk/present/result/result_document.h"

namespace mbk::result {
namespace {

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
  const std::string on = json.value("validated_on", kHeldOut);
  fit.held_out = on == kHeldOut || on == "held-back";  // so until the version before
  return fit;
}

std::vector<Warning> warnings_from(const Json& json) {
  if (!json.is_array()) throw Malformed{"'warnings' is not a list"};
  std::vector<Warning> warnings;
  for (const Json& one : json) {
    const std::string code = one.value("code", "");
    const auto known = value_of<WarningCode>(code);
    if (!known) throw Malformed{fmt::format("unknown warning '{}'", code)};
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

/// Rows of M; 2 if they are not 1, 2 or 3.
Index axes_of(const Json& json) {
  const auto model = json.find("model");
  const bool listed = model != json.end() && model->is_object() && model->contains("M") && (*model)["M"].is_array();
  const std::size_t rows = listed ? (*model)["M"].size() : 0;
  return rows == 1 || rows == 3 ? static_cast<Index>(rows) : 2;
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
        throw Malformed{"'results' is empty"};
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
