#include "mbk/present/result/transfer_function_json.h"

#include "mbk/base/core/units.h"
#include "mbk/present/result/json_parts.h"

namespace mbk::result {
namespace {

Json roots_json(const std::vector<Root>& roots) {
  Json array = Json::array();
  for (const Root& root : roots) {
    array.push_back({{"re", number(root.value.real())},
                     {"im", number(root.value.imag())},
                     {"pair", root.pair},
                     {"frequency_hz", number(root.frequency)},
                     {"frequency_standard_error_hz", number(root.frequency_standard_error)},
                     {"damping", number(root.damping)},
                     {"damping_standard_error", number(root.damping_standard_error)},
                     {"outside_band", root.outside_band}});
  }
  return array;
}

Json columns_json(const Matrix& matrix) {
  Json array = Json::array();
  for (Index k = 0; k < matrix.cols(); ++k) array.push_back(list(matrix.col(k)));
  return array;
}

/// Ends of value ± half width.
Json around(const Vector& value, const Vector& half_width) {
  return Json::array({list(value - half_width), list(value + half_width)});
}

Json response_json(const FrequencyResponse& response) {
  const Vector real = response.value.real();
  return {{"frequency_hz", list(response.frequency)},
          {"magnitude", list(response.value.cwiseAbs())},
          {"magnitude_interval95", columns_json(response.magnitude95)},
          {"phase_deg", list(kDegrees * response.phase)},
          {"phase_interval95_deg", around(kDegrees * response.phase, kDegrees * response.phase_half_width)},
          {"real", list(real)},
          {"real_interval95", around(real, response.real_half_width)},
          {"imaginary", list(response.value.imag())},
          {"region95",
           {{"longer_half_axis", list(response.region95.col(0))},
            {"shorter_half_axis", list(response.region95.col(1))},
            {"angle_deg", list(kDegrees * response.region95.col(2))}}}};
}

Json inverse_json(const InvertedAdmittance& inverse) {
  const Units units = units_of(inverse.motion);
  Json json = {{"admittance_to", word_of(inverse.output)},
               {"units", {{"M", units.inertia}, {"B", units.damping}, {"K", units.stiffness}}},
               {"unstable", inverse.unstable}};
  const auto add = [&](const char* name, const std::optional<Estimate>& value) {
    if (value) json[name] = {{"value", number(value->value)}, {"standard_error", number(value->standard_error)}};
  };
  add("M", inverse.M);
  add("B", inverse.B);
  add("K", inverse.K);
  json["force_per_velocity"] = response_json(inverse.impedance);
  json["force_per_displacement"] = response_json(inverse.stiffness);
  return json;
}

Json document(const TransferFunctionIdentification& found, const TransferFunctionFindings& findings) {
  Json json = header("mbk.tf/1");
  json["inputs"] = inputs_json(found.sources);
  json["method"] = word_of(found.method);
  json["input"] = {{"name", found.input}, {"unit", found.input_unit}};
  json["output"] = {{"name", found.output}, {"unit", found.output_unit}};
  if (!found.reference.empty()) json["reference"] = found.reference;
  const bool continuous = found.model.sample_time == 0.0;
  const auto highest_first = [&](const Vector& c) { return list(continuous ? Vector(c.reverse()) : c); };
  json["numerator"] = highest_first(found.model.numerator);
  json["denominator"] = highest_first(found.model.denominator);
  json["variable"] = continuous ? "s" : "q^-1";
  json["sample_time"] = found.model.sample_time;
  json["delay_s"] = found.model.delay;
  json["delay_found"] = found.delay_found;
  if (found.max_delay > 0.0) json["max_delay_s"] = number(found.max_delay);
  if (found.delay_standard_error) json["delay_standard_error_s"] = number(*found.delay_standard_error);
  if (found.hold) {
    json["hold"] = word_of(*found.hold);
    json["hold_found"] = found.hold_found;
  }
  const Index n = found.model.poles(), q = found.model.numerator.size();
  json["parameters"] = Json::array();
  const auto add = [&](std::string name, double value, Index at) {
    json["parameters"].push_back({{"name", std::move(name)},
                                  {"value", number(value)},
                                  {"standard_error", number(std::sqrt(found.covariance(at, at)))}});
  };
  for (Index k = 0; k < n; ++k) {
    const Index power = continuous ? k : k + 1;
    add(fmt::format("{}{}", continuous ? "a" : "f", power), found.model.denominator[power], k);
  }
  for (Index k = 0; k < q; ++k) add(fmt::format("b{}", k), found.model.numerator[k], n + k);
  json["covariance"] = rows(found.covariance);
  json["hac_lag_s"] = found.hac_lag_s;
  json["poles"] = roots_json(found.poles);
  json["zeros"] = roots_json(found.zeros);
  json["gain"] = number(found.gain);
  json["gain_standard_error"] = number(found.gain_standard_error);
  json["fit"] = {{"R2_in_sample", number(found.fit)},
                 {"noise_standard_deviation", number(found.noise_standard_deviation)},
                 {"YIC", number(found.yic)},
                 {"AIC", number(found.aic)},
                 {"BIC", number(found.bic)}};
  if (found.held_out_fit) {
    json["fit"]["R2_held_out"] = number(*found.held_out_fit);
    json["fit"]["RMSE_held_out"] = number(found.held_out_rmse);
  }
  if (found.noise_denominator.size() > 1) json["noise"]["denominator"] = list(found.noise_denominator);
  if (found.noise_numerator.size() > 1) json["noise"]["numerator"] = list(found.noise_numerator);
  json["residuals"] = {{"lags", found.residuals.lags},
                       {"white", found.residuals.white()},
                       {"whiteness_p", number(found.residuals.whiteness_p)},
                       {"autocorrelation_outside", number(found.residuals.autocorrelation_outside)},
                       {"independent_of_input", found.residuals.independent()},
                       {"cross_p", number(found.residuals.cross_p)},
                       {"cross_correlation_outside", number(found.residuals.cross_correlation_outside)}};
  json["starts"] = Json::array();
  for (const SearchStart& start : found.starts) {
    json["starts"].push_back({{"pole_rad_s", number(start.pole)},
                              {"converged", start.converged},
                              {"stable", start.stable},
                              {"iterations", start.iterations},
                              {"R2", number(start.fit)}});
    if (!start.made_by.empty()) json["starts"].back()["made_by"] = start.made_by;
  }
  if (!found.orders.empty()) json["orders"] = Json::array();
  for (const OrderChoice& one : found.orders) {
    json["orders"].push_back({{"poles", one.poles},
                              {"zeros", one.zeros},
                              {"usable", one.usable},
                              {"R2", number(one.fit)},
                              {"YIC", number(one.yic)},
                              {"AIC", number(one.aic)},
                              {"BIC", number(one.bic)},
                              {"chosen", one.chosen}});
  }
  json["frequency_response"] = response_json(findings.response);
  if (findings.inverse) json["impedance"] = inverse_json(*findings.inverse);
  json["excited_band_hz"] = {number(found.band_low), number(found.band_high)};
  json["samples"] = found.samples;
  json["experiments"] = found.experiments;
  json["even_clock"] = found.even;
  json["sample_time_s"] = number(found.sample_time);
  if (found.recorded_rate_hz > 0.0) json["recorded_rate_hz"] = found.recorded_rate_hz;
  json["notes"] = found.notes;
  json["warnings"] = warnings_json(found.warnings);
  json["usable"] = found.usable;
  return json;
}

}  // namespace

std::string to_json(const TransferFunctionIdentification& found, const TransferFunctionFindings& findings) {
  return dumped(document(found, findings));
}

std::string report_json(const TransferFunctionIdentification& found, const TransferFunctionFindings& findings,
                        const std::string& command, const std::string& note) {
  Json json = header("mbk.tf_report/1");
  json["command"] = command;
  if (!note.empty()) json["note"] = note;
  json["simulation"] = {{"held_out", found.held_out_fit.has_value()},
                        {"time_s", rounded(findings.drawn.time, kTimeDigits)},
                        {"measured", rounded(findings.drawn.measured)},
                        {"simulated", rounded(findings.drawn.simulated)}};
  json["result"] = document(found, findings);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mbk::result
