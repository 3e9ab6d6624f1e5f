#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/version.h"
#include "mbk/model/trial/chart.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

/// What every JSON document of mbk is put together from. For the sources of this module only.
namespace mbk::result {

using Json = nlohmann::ordered_json;

/// null where a number is undefined.
inline Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

inline Json list(const Vector& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(number(value));
  return array;
}

inline constexpr int kDigits = 6, kTimeDigits = 9;  ///< of what is only there to be looked at

/// The number with so many digits; null where it is undefined.
inline Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

inline Json rounded(const Vector& values, int digits = kDigits) {
  Json array = Json::array();
  for (const double value : values) array.push_back(rounded(value, digits));
  return array;
}

/// [low, high]
inline Json interval(const std::pair<double, double>& value, double scale = 1.0) {
  return Json::array({number(scale * value.first), number(scale * value.second)});
}

inline Json rows(const Matrix& matrix) {
  Json array = Json::array();
  for (Index i = 0; i < matrix.rows(); ++i) array.push_back(list(matrix.row(i).transpose()));
  return array;
}

/// Names of files and channels may hold bytes that are not UTF-8, which JSON cannot say: they become U+FFFD.
inline std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

inline Json units_json(Motion motion) {
  const Units units = units_of(motion);
  return {{"M", units.inertia},
          {"B", units.damping},
          {"K", units.stiffness},
          {"x0", units.position},
          {"force", units.force}};
}

/// What the fit was judged on.
inline const char* validated_on(bool held_out) {
  return held_out ? "held-out" : "in-sample";
}

inline Json header(const char* schema) {
  return {{"schema", schema}, {"software", fmt::format("mbk {}", version())}};
}

inline Json inputs_json(const std::vector<SourceFile>& sources) {
  Json inputs = Json::array();
  for (const SourceFile& source : sources) {
    inputs.push_back({{"file", source.path}, {"sha256", source.sha256}, {"format", source.format}});
    if (!source.trial.empty()) inputs.back()["trial"] = source.trial;
  }
  return inputs;
}

inline Json warnings_json(const std::vector<Warning>& warnings) {
  Json array = Json::array();
  for (const Warning& warning : warnings) {
    Json one = {{"code", word_of(warning.code)}, {"message", warning.message}, {"try", warning.remedy}};
    const std::string_view was = warning.was.empty() ? former_word_of(warning.code) : warning.was;
    if (!was.empty()) one["was"] = was;
    array.push_back(std::move(one));
  }
  return array;
}

inline Json preparation_json(const Preparation& how) {
  Json json = {{"protocol", word_of(how.protocol)},
               {"protocol_rule", how.protocol_rule},
               {"window_rule", how.window_rule},
               {"from_s", how.from_s},
               {"to_s", how.to_s},
               {"savitzky_golay", {{"order", how.smoothing_order}, {"window", how.smoothing_window}}},
               {"cutoff_hz", how.cutoff ? Json(how.cutoff->value) : Json(nullptr)},
               {"cutoff_rule", how.cutoff_rule},
               {"every", how.every},
               {"excited_band_hz", {how.band_low.value, how.band_high.value}},
               {"force_source", word_of(how.force_source)},
               {"acceleration",
                word_of(how.acceleration_from_sensor ? AccelerationSource::sensor : AccelerationSource::derivative)},
               {"cut_before_filter", how.cut_before_filter}};
  if (how.split_s) json["split_s"] = *how.split_s;
  if (how.protocol == Protocol::underdamped) json["perturbations"] = how.perturbations;
  if (how.mode == Mode::reference) json["procedure"] = word_of(how.procedure);
  return json;
}

/// Lines of a chart that are there to compare with.
inline Json references_json(const std::vector<ChartReference>& lines) {
  Json array = Json::array();
  for (const ChartReference& line : lines) array.push_back({{"value", number(line.value)}, {"name", line.name}});
  return array;
}

}  // namespace mbk::result
