#include "mbk/present/result/sensor_json.h"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <vector>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

constexpr const char* kSensorSchema = "mbk.sensor/1";

using document::Fields;

void describe(Fields<ForceOnVoltage>& fields) {
  fields.type("ForceOnVoltage", "Regression of force on voltage for this axis alone.");
  fields.add("slope", &ForceOnVoltage::slope, "[N/V]");
  fields.add("slope_standard_error", &ForceOnVoltage::slope_error, "[N/V]");
  fields.add("intercept", &ForceOnVoltage::intercept, "[N]");
  fields.add("intercept_standard_error", &ForceOnVoltage::intercept_error, "[N]");
  fields.add("r_squared", &ForceOnVoltage::r_squared);
}

void describe(Fields<SensorAxis>& fields) {
  fields.type("SensorAxis");
  fields.add_as("name", {{"enum", {"x", "y"}}}, &SensorAxis::name);
  fields.add("zero_voltage", &SensorAxis::zero_voltage, "V₀ [V]");
  fields.add("zero_voltage_standard_error", &SensorAxis::zero_voltage_error, "[V]");
  fields.add("intercept", &SensorAxis::intercept, "force at 0 V on every axis [N]");
  fields.add("intercept_standard_error", &SensorAxis::intercept_error, "[N]");
  fields.add("r_squared", &SensorAxis::r_squared);
  fields.add("RMSE", &SensorAxis::rmse, "[N]");
  fields.add("force_on_voltage", &SensorAxis::published);
  fields.add("full_scale", &SensorAxis::full_scale, "largest load [N]");
  fields.add("loads", &SensorAxis::loads, "number of different loads");
  fields.add("nonlinearity", &SensorAxis::nonlinearity, "[N]");
  fields.add("hysteresis", &SensorAxis::hysteresis, "[N]");
  fields.add("noise_voltage", &SensorAxis::noise, "[V]");
  fields.add("step_voltage", &SensorAxis::step, "smallest step of the data [V]");
  fields.add("converter_step_voltage", &SensorAxis::conversion, "[V]");
}

void describe(Fields<SensorWarning>& fields) {
  fields.type("SensorWarning");
  fields.add("code", &SensorWarning::code);
  fields.add("message", &SensorWarning::message);
  fields.add("try", &SensorWarning::remedy, "what to do");
}

void describe(Fields<SensorCalibration>& fields) {
  fields.type("Sensor",
              "Output of `mbk sensor calibrate --json`: F = S (V − V₀) of a force sensor. SI units, V: volts.");
  fields.header(kSensorSchema);
  fields.constant("what", "calibrate");
  fields.add("inputs", &SensorCalibration::sources);
  fields.add("continuous", &SensorCalibration::continuous, "from recordings over time; otherwise one row per load");
  fields.add("rows", &SensorCalibration::rows, "of tables, or samples");
  fields.add("lever_arm", &SensorCalibration::lever_arm, "from the gauges to the load [m]");
  fields.add("delay", &SensorCalibration::delay, "lag of the voltage behind the load [s]");
  fields.add_if(&SensorCalibration::continuous, "hac_lag_s", &SensorCalibration::hac_lag_s, "[s]");
  fields.add("slope", &SensorCalibration::slope, "S [N/V]");
  fields.add("slope_standard_error", &SensorCalibration::slope_error, "[N/V]");
  const auto crosstalk = [](const SensorCalibration& calibration) { return calibration.crosstalk.size() > 0; };
  fields.add_if(crosstalk, "crosstalk", &SensorCalibration::crosstalk, "response of axis j to a load on axis i [N/N]");
  fields.add_if(crosstalk, "crosstalk_standard_error", &SensorCalibration::crosstalk_error, "[N/N]");
  fields.add("axes", &SensorCalibration::axes);
  fields.add("zero_voltages", &SensorCalibration::zero_voltages, "V₀ of each run [V]");
  fields.add("warnings", &SensorCalibration::warnings);
  fields.add("notes", &SensorCalibration::notes);
}

void describe(Fields<MeasuredDelay>& fields) {
  using From = const MeasuredDelay&;
  fields.type("SensorDelay",
              "Output of `mbk sensor delay --json`: delay of a force sensor, from the motion of a known "
              "mass. SI units.");
  fields.header("mbk.sensor_delay/1");
  fields.add("inputs", &MeasuredDelay::sources);
  fields.add("delay_s", &MeasuredDelay::delay, "above 0: the force is recorded after the motion");
  fields.add("delay_interval95_s", [](From found) { return numeric::interval95(found.delay, found.delay_error); });
  fields.add("mass_kg", &MeasuredDelay::mass, "as found");
  fields.add("mass_interval95_kg", [](From found) { return numeric::interval95(found.mass, found.mass_error); });
  fields.add("stated_mass_kg", &MeasuredDelay::stated_mass);
  fields.add("VAF", &MeasuredDelay::vaf, "VAF of the force by the mass alone, minimum over the axes [%]");
  fields.add("duration_s", &MeasuredDelay::duration);
  fields.add("usable", &MeasuredDelay::usable);
  fields.add("problems", &MeasuredDelay::problems, "why the delay is not usable");
}

namespace result {
namespace {

using document::Json;

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
  return document::document(calibration);
}

Result<SensorCalibration> sensor_calibration_from_json(std::string_view text) {
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    return bad_data(fmt::format("not JSON, at byte {}", error.byte), "give a file of 'mbk sensor calibrate --json'");
  } catch (const Json::exception&) {
    return bad_data("a number is out of range", "give a file of 'mbk sensor calibrate --json'");
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
  if (!reader.problem.empty()) return bad_data(reader.problem, "calibrate again, or correct the file");
  return calibration;
}

std::string to_json(const MeasuredDelay& found) {
  return document::document(found);
}

void add_sensor_schemas(document::Schemas& schemas) {
  schemas["sensor"] = document::schema_of<SensorCalibration>();
  schemas["sensor_delay"] = document::schema_of<MeasuredDelay>();
}

}  // namespace result
}  // namespace mbk
