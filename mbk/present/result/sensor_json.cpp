#include "mbk/present/result/sensor_json.h"

#include <limits>
#include <optional>
#include <vector>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/present/result/json_parts.h"

namespace mbk::result {
namespace {

constexpr const char* kSensorSchema = "mbk.sensor/1";

Json line_json(const ForceOnVoltage& line) {
  return {{"slope", number(line.slope)},
          {"slope_standard_error", number(line.slope_error)},
          {"intercept", number(line.intercept)},
          {"intercept_standard_error", number(line.intercept_error)},
          {"r_squared", number(line.r_squared)}};
}

Json axis_json(const SensorAxis& axis) {
  Json json = {{"name", axis.name},
               {"zero_voltage", number(axis.zero_voltage)},
               {"zero_voltage_standard_error", number(axis.zero_voltage_error)},
               {"intercept", number(axis.intercept)},
               {"intercept_standard_error", number(axis.intercept_error)},
               {"r_squared", number(axis.r_squared)},
               {"RMSE", number(axis.rmse)},
               {"force_on_voltage", line_json(axis.published)},
               {"full_scale", number(axis.full_scale)},
               {"loads", axis.loads},
               {"nonlinearity", number(axis.nonlinearity)}};
  if (axis.hysteresis) json["hysteresis"] = number(*axis.hysteresis);
  if (axis.noise) json["noise_voltage"] = number(*axis.noise);
  if (axis.step) json["step_voltage"] = number(*axis.step);
  if (axis.conversion) json["converter_step_voltage"] = number(*axis.conversion);
  return json;
}

/// Members of a document, with the first that is missing or wrong.
class Reader {
 public:
  double number(const Json& json, const char* name) {
    const auto found = json.find(name);
    if (found != json.end() && found->is_number()) return found->get<double>();
    return wrong(name, "a number");
  }
  /// NaN where it is null or missing.
  static double or_undefined(const Json& json, const char* name) {
    const auto found = json.find(name);
    return found != json.end() && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
  }
  static std::optional<double> maybe(const Json& json, const char* name) {
    const auto found = json.find(name);
    return found != json.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
  }
  static Index count(const Json& json, const char* name) {
    constexpr double kMax = 1e15;
    const double value = maybe(json, name).value_or(0.0);
    return value >= 0.0 && value <= kMax ? static_cast<Index>(value) : 0;
  }
  Matrix matrix(const Json& json, const char* name, Index n) {
    Matrix values = Matrix::Constant(n, n, std::numeric_limits<double>::quiet_NaN());
    const auto found = json.find(name);
    if (found == json.end() || !found->is_array() || std::ssize(*found) != n) {
      wrong(name, fmt::format("a {0}×{0} matrix", n));
      return values;
    }
    for (Index i = 0; i < n; ++i) {
      const Json& row = (*found)[static_cast<std::size_t>(i)];
      if (!row.is_array() || std::ssize(row) != n) {
        wrong(name, fmt::format("a {0}×{0} matrix", n));
        return values;
      }
      for (Index j = 0; j < n; ++j) {
        const Json& value = row[static_cast<std::size_t>(j)];
        if (value.is_number()) values(i, j) = value.get<double>();
      }
    }
    return values;
  }
  double wrong(const char* name, const std::string& expected) {
    if (problem.empty()) problem = fmt::format("'{}' is not {}", name, expected);
    return std::numeric_limits<double>::quiet_NaN();
  }

  std::string problem;
};

SensorAxis axis_from(Reader& reader, const Json& json) {
  SensorAxis axis;
  if (!json.is_object()) {
    reader.wrong("axes", "a list of axes");
    return axis;
  }
  axis.name = json.value("name", Json()).is_string() ? json["name"].get<std::string>() : "";
  if (axis.name != "x" && axis.name != "y") reader.wrong("name", "x or y");
  axis.zero_voltage = reader.number(json, "zero_voltage");
  axis.zero_voltage_error = Reader::or_undefined(json, "zero_voltage_standard_error");
  axis.intercept = Reader::or_undefined(json, "intercept");
  axis.intercept_error = Reader::or_undefined(json, "intercept_standard_error");
  axis.r_squared = Reader::or_undefined(json, "r_squared");
  axis.rmse = Reader::or_undefined(json, "RMSE");
  axis.full_scale = Reader::or_undefined(json, "full_scale");
  axis.nonlinearity = Reader::or_undefined(json, "nonlinearity");
  axis.loads = Reader::count(json, "loads");
  axis.hysteresis = Reader::maybe(json, "hysteresis");
  axis.noise = Reader::maybe(json, "noise_voltage");
  axis.step = Reader::maybe(json, "step_voltage");
  axis.conversion = Reader::maybe(json, "converter_step_voltage");
  if (const auto line = json.find("force_on_voltage"); line != json.end() && line->is_object()) {
    axis.published = {Reader::or_undefined(*line, "slope"), Reader::or_undefined(*line, "slope_standard_error"),
                      Reader::or_undefined(*line, "intercept"), Reader::or_undefined(*line, "intercept_standard_error"),
                      Reader::or_undefined(*line, "r_squared")};
  }
  return axis;
}

std::string text_or_empty(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

void read_provenance(SensorCalibration& calibration, const Json& json) {
  const auto each = [&](const char* name, const auto& take) {
    const auto list = json.find(name);
    if (list == json.end() || !list->is_array()) return;
    for (const Json& one : *list) take(one);
  };
  each("inputs", [&](const Json& one) {
    if (!one.is_object()) return;
    calibration.sources.push_back(
        {text_or_empty(one, "file"), text_or_empty(one, "format"), text_or_empty(one, "sha256")});
  });
  each("warnings", [&](const Json& one) {
    const auto code = one.is_object() ? value_of<SensorWarningCode>(text_or_empty(one, "code")) : std::nullopt;
    if (code) calibration.warnings.push_back({*code, text_or_empty(one, "message"), text_or_empty(one, "try")});
  });
  each("notes", [&](const Json& one) {
    if (one.is_string()) calibration.notes.push_back(one.get<std::string>());
  });
  each("zero_voltages", [&](const Json& one) {
    Vector zero(std::ssize(calibration.axes));
    for (Index k = 0; k < zero.size(); ++k) {
      const bool there =
          one.is_array() && std::ssize(one) == zero.size() && one[static_cast<std::size_t>(k)].is_number();
      zero[k] = there ? one[static_cast<std::size_t>(k)].get<double>() : std::numeric_limits<double>::quiet_NaN();
    }
    calibration.zero_voltages.push_back(std::move(zero));
  });
}

}  // namespace

std::string to_json(const SensorCalibration& calibration) {
  Json json = header(kSensorSchema);
  json["what"] = "calibrate";
  json["inputs"] = inputs_json(calibration.sources);
  json["continuous"] = calibration.continuous;
  json["rows"] = calibration.rows;
  if (calibration.lever_arm) json["lever_arm"] = number(*calibration.lever_arm);
  json["delay"] = number(calibration.delay);
  if (calibration.continuous) json["hac_lag_s"] = number(calibration.hac_lag_s);
  json["slope"] = rows(calibration.slope);
  json["slope_standard_error"] = rows(calibration.slope_error);
  if (calibration.crosstalk.size() > 0) {
    json["crosstalk"] = rows(calibration.crosstalk);
    json["crosstalk_standard_error"] = rows(calibration.crosstalk_error);
  }
  json["axes"] = Json::array();
  for (const SensorAxis& axis : calibration.axes) json["axes"].push_back(axis_json(axis));
  json["zero_voltages"] = Json::array();
  for (const Vector& zero : calibration.zero_voltages) json["zero_voltages"].push_back(list(zero));
  json["warnings"] = Json::array();
  for (const SensorWarning& warning : calibration.warnings) {
    json["warnings"].push_back(
        {{"code", word_of(warning.code)}, {"message", warning.message}, {"try", warning.remedy}});
  }
  json["notes"] = calibration.notes;
  return dumped(json);
}

Result<SensorCalibration> sensor_calibration_from_json(std::string_view text) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    return bad_data(fmt::format("not JSON, at byte {}", error.byte), "give a file of 'mbk sensor calibrate --json'");
  } catch (const Json::exception&) {
    return bad_data("a number is beyond what can be said", "give a file of 'mbk sensor calibrate --json'");
  }
  if (!json.is_object() || text_or_empty(json, "schema") != kSensorSchema) {
    return bad_data(fmt::format("not a calibration of schema {}", kSensorSchema),
                    "give a file of 'mbk sensor calibrate --json'");
  }
  Reader reader;
  SensorCalibration calibration;
  const auto axes = json.find("axes");
  if (axes == json.end() || !axes->is_array() || axes->empty() || axes->size() > 2) {
    return bad_data("'axes' is not a list of one or two axes");
  }
  for (const Json& axis : *axes) calibration.axes.push_back(axis_from(reader, axis));
  const Index n = std::ssize(calibration.axes);
  if (n == 2 && calibration.axes[0].name == calibration.axes[1].name) reader.wrong("axes", "x and y");
  calibration.slope = reader.matrix(json, "slope", n);
  if (!calibration.slope.allFinite() || numeric::determinant(calibration.slope) == 0.0) {
    reader.wrong("slope", "a matrix of numbers that can be inverted");
  }
  calibration.slope_error = reader.matrix(json, "slope_standard_error", n);
  if (json.contains("crosstalk")) {
    calibration.crosstalk = reader.matrix(json, "crosstalk", n);
    calibration.crosstalk_error = reader.matrix(json, "crosstalk_standard_error", n);
  }
  calibration.lever_arm = Reader::maybe(json, "lever_arm");
  if (calibration.lever_arm && !(*calibration.lever_arm > 0.0)) reader.wrong("lever_arm", "above 0");
  calibration.delay = Reader::maybe(json, "delay").value_or(0.0);
  calibration.rows = Reader::count(json, "rows");
  calibration.hac_lag_s = Reader::maybe(json, "hac_lag_s").value_or(0.0);
  calibration.continuous = json.value("continuous", Json()) == Json(true);
  read_provenance(calibration, json);
  if (!reader.problem.empty()) return bad_data(reader.problem, "calibrate again, or mend the file");
  return calibration;
}

std::string to_json(const MeasuredDelay& found) {
  Json json = header("mbk.sensor_delay/1");
  json["inputs"] = inputs_json(found.sources);
  json["delay_s"] = number(found.delay);
  json["delay_interval95_s"] = interval(numeric::interval95(found.delay, found.delay_error));
  json["mass_kg"] = number(found.mass);
  json["mass_interval95_kg"] = interval(numeric::interval95(found.mass, found.mass_error));
  json["stated_mass_kg"] = number(found.stated_mass);
  json["VAF"] = number(found.vaf);
  json["duration_s"] = number(found.duration);
  json["usable"] = found.usable();
  json["problems"] = found.problems;
  return dumped(json);
}

}  // namespace mbk::result
