#include "mbk/present/result/transfer_function_json.h"

#include <fmt/format.h>

#include <cmath>

#include "mbk/base/core/units.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::through;

void describe(Fields<Root>& fields) {
  fields.type("Root", "A pole or a zero; of a pair the one with positive imaginary part.");
  fields.add(
      "re", [](const Root& root) { return root.value.real(); }, "[rad/s]");
  fields.add(
      "im", [](const Root& root) { return root.value.imag(); }, "[rad/s]");
  fields.add("pair", &Root::pair);
  fields.add("frequency_hz", &Root::frequency, "[Hz]");
  fields.add("frequency_standard_error_hz", &Root::frequency_standard_error, "[Hz]");
  fields.add("damping", &Root::damping);
  fields.add("damping_standard_error", &Root::damping_standard_error);
  fields.add("outside_band", &Root::outside_band, "outside the excited band");
}

void describe(Fields<FrequencyResponse>& fields) {
  using From = const FrequencyResponse&;
  using Ends = std::array<Vector, 2>;
  const auto around = [](const Vector& value, const Vector& half_width) -> Ends {
    return {value - half_width, value + half_width};
  };
  fields.type("FrequencyResponse", "Frequency response with 95 % intervals.");
  fields.add("frequency_hz", &FrequencyResponse::frequency, "[Hz]");
  fields.add("magnitude", [](From response) -> Vector { return response.value.cwiseAbs(); });
  fields.add(
      "magnitude_interval95",
      [](From response) -> Ends {
        return {response.magnitude95.col(0), response.magnitude95.col(1)};
      },
      "low and high ends");
  fields.add(
      "phase_deg", [](From response) -> Vector { return kDegrees * response.phase; }, "[°]");
  fields.add(
      "phase_interval95_deg",
      [around](From response) { return around(kDegrees * response.phase, kDegrees * response.phase_half_width); },
      "low and high ends [°]");
  fields.add("real", [](From response) -> Vector { return response.value.real(); });
  fields.add(
      "real_interval95", [around](From response) { return around(response.value.real(), response.real_half_width); },
      "low and high ends");
  fields.add("imaginary", [](From response) -> Vector { return response.value.imag(); });
  const auto region = [](Fields<FrequencyResponse>& part) {
    part.add("longer_half_axis", [](From response) -> Vector { return response.region95.col(0); });
    part.add("shorter_half_axis", [](From response) -> Vector { return response.region95.col(1); });
    part.add(
        "angle_deg", [](From response) -> Vector { return kDegrees * response.region95.col(2); },
        "angle of the major axis from the real axis [°]");
  };
  fields.group("region95", region, "Ellipse that contains the value with 95 % confidence.");
}

void describe(Fields<Estimate>& fields) {
  fields.type("Estimate");
  fields.add("value", &Estimate::value);
  fields.add("standard_error", &Estimate::standard_error);
}

void describe(Fields<InvertedAdmittance>& fields) {
  using From = const InvertedAdmittance&;
  fields.type("InvertedAdmittance", "The impedance, if the input is a force and the output a motion.");
  fields.add("admittance_to", &InvertedAdmittance::output);
  fields.group("units", [](Fields<InvertedAdmittance>& part) {
    part.add("M", [](From inverse) { return units_of(inverse.motion).inertia; });
    part.add("B", [](From inverse) { return units_of(inverse.motion).damping; });
    part.add("K", [](From inverse) { return units_of(inverse.motion).stiffness; });
  });
  fields.add("unstable", &InvertedAdmittance::unstable);
  fields.add("M", &InvertedAdmittance::M);
  fields.add("B", &InvertedAdmittance::B);
  fields.add("K", &InvertedAdmittance::K);
  fields.add("force_per_velocity", &InvertedAdmittance::impedance);
  fields.add("force_per_displacement", &InvertedAdmittance::stiffness);
}

void describe(Fields<ResidualTests>& fields) {
  fields.type("ResidualTests");
  fields.add("lags", &ResidualTests::lags);
  fields.add("white", &ResidualTests::white);
  fields.add("whiteness_p", &ResidualTests::whiteness_p);
  fields.add("autocorrelation_outside", &ResidualTests::autocorrelation_outside, "share");
  fields.add("independent_of_input", &ResidualTests::independent);
  fields.add("cross_p", &ResidualTests::cross_p);
  fields.add("cross_correlation_outside", &ResidualTests::cross_correlation_outside, "share");
}

void describe(Fields<SearchStart>& fields) {
  fields.type("SearchStart");
  fields.add("pole_rad_s", &SearchStart::pole, "[rad/s]");
  fields.add("converged", &SearchStart::converged);
  fields.add("stable", &SearchStart::stable);
  fields.add("iterations", &SearchStart::iterations);
  fields.add("R2", &SearchStart::fit);
  fields.add_unless_empty("made_by", &SearchStart::made_by);
}

void describe(Fields<OrderChoice>& fields) {
  fields.type("OrderChoice");
  fields.add("poles", &OrderChoice::poles);
  fields.add("zeros", &OrderChoice::zeros);
  fields.add("usable", &OrderChoice::usable);
  fields.add("R2", &OrderChoice::fit);
  fields.add("YIC", &OrderChoice::yic);
  fields.add("AIC", &OrderChoice::aic);
  fields.add("BIC", &OrderChoice::bic);
  fields.add("chosen", &OrderChoice::chosen);
}

namespace result {
namespace {

using Found = TransferFunctionIdentification;

bool is_continuous(const Found& found) {
  return found.model.sample_time == 0.0;
}

Vector highest_first(const Found& found, const Vector& coefficients) {
  return is_continuous(found) ? Vector(coefficients.reverse()) : coefficients;
}

struct Signal {
  std::string name, unit;
};

void describe(Fields<Signal>& fields) {
  fields.type("Signal");
  fields.add("name", &Signal::name);
  fields.add("unit", &Signal::unit);
}

struct Parameter {
  std::string name;
  double value, standard_error;
};

void describe(Fields<Parameter>& fields) {
  fields.type("TransferFunctionParameter");
  fields.add("name", &Parameter::name);
  fields.add("value", &Parameter::value);
  fields.add("standard_error", &Parameter::standard_error);
}

std::vector<Parameter> parameters_of(const Found& found) {
  std::vector<Parameter> parameters;
  const auto add = [&](std::string name, double value) {
    const Index at = std::ssize(parameters);
    parameters.push_back({std::move(name), value, std::sqrt(found.covariance(at, at))});
  };
  for (Index k = 0; k < found.model.poles(); ++k) {
    const Index power = is_continuous(found) ? k : k + 1;
    add(fmt::format("{}{}", is_continuous(found) ? "a" : "f", power), found.model.denominator[power]);
  }
  for (Index k = 0; k < found.model.numerator.size(); ++k) add(fmt::format("b{}", k), found.model.numerator[k]);
  return parameters;
}

struct Document {
  const Found* found;
  const TransferFunctionFindings* findings;
};

void describe(Fields<Document>& fields) {
  using From = const Document&;
  const auto of = [](auto get) { return [get](From one) -> decltype(auto) { return std::invoke(get, *one.found); }; };
  const auto model = of(&Found::model);
  const auto noise_there = [](const Vector& noise) { return noise.size() > 1; };
  fields.type("TransferFunction",
              "Output of `mbk tf --json`. Numerator and denominator from the highest power of s to the constant; "
              "discrete ones start with q⁰.");
  fields.header("mbk.tf/1");
  fields.add("inputs", of(&Found::sources));
  fields.add("method", of(&Found::method));
  fields.add("input", [](From one) { return Signal{one.found->input, one.found->input_unit}; });
  fields.add("output", [](From one) { return Signal{one.found->output, one.found->output_unit}; });
  fields.add_unless_empty("reference", of(&Found::reference), "channel");
  fields.add("numerator", [](From one) { return highest_first(*one.found, one.found->model.numerator); });
  fields.add("denominator", [](From one) { return highest_first(*one.found, one.found->model.denominator); });
  fields.add_choice("variable", of(is_continuous), "s", "q^-1");
  fields.add_number("sample_time", through(model, &TransferFunction::sample_time),
                    "sample time of a discrete model [s]; 0: continuous");
  fields.add_number("delay_s", through(model, &TransferFunction::delay), "[s]");
  fields.add("delay_found", of(&Found::delay_found), "below max_delay_s");
  fields.add_if([](From one) { return one.found->max_delay > 0.0; }, "max_delay_s", of(&Found::max_delay),
                "longest delay tried [s]; absent if the delay was given");
  fields.add("delay_standard_error_s", of(&Found::delay_standard_error),
             "of an estimated delay [s]; absent if the standard errors treat the delay as known");
  fields.add("hold", of(&Found::hold), "of the input between samples; absent in discrete time");
  fields.add_if([](From one) { return one.found->hold.has_value(); }, "hold_found", of(&Found::hold_found),
                "chosen from the steps of the input");
  fields.add("parameters", of(parameters_of));
  fields.add("covariance", of(&Found::covariance));
  fields.add_number("hac_lag_s", of(&Found::hac_lag_s), "[s]");
  fields.add("poles", of(&Found::poles));
  fields.add("zeros", of(&Found::zeros));
  fields.add("gain", of(&Found::gain));
  fields.add("gain_standard_error", of(&Found::gain_standard_error));
  fields.group("fit", [of](Fields<Document>& part) {
    part.add("R2_in_sample", of(&Found::fit));
    part.add("noise_standard_deviation", of(&Found::noise_standard_deviation));
    part.add("YIC", of(&Found::yic));
    part.add("AIC", of(&Found::aic));
    part.add("BIC", of(&Found::bic));
    part.add("R2_held_out", of(&Found::held_out_fit));
    part.add_if([](From one) { return one.found->held_out_fit.has_value(); }, "RMSE_held_out",
                of(&Found::held_out_rmse));
  });
  const auto denominator = of(&Found::noise_denominator), numerator = of(&Found::noise_numerator);
  const auto noise = [=](Fields<Document>& part) {
    part.add("denominator", denominator).only_if(through(denominator, noise_there));
    part.add("numerator", numerator).only_if(through(numerator, noise_there));
  };
  fields.group("noise", noise, "Noise model; coefficients start with q⁰.").only_if([=](From one) {
    return noise_there(denominator(one)) || noise_there(numerator(one));
  });
  fields.add("residuals", of(&Found::residuals));
  fields.add("starts", of(&Found::starts));
  fields.add_unless_empty("orders", of(&Found::orders));
  fields.add("frequency_response", through(&Document::findings, &TransferFunctionFindings::response));
  fields.add("impedance", through(&Document::findings, &TransferFunctionFindings::inverse));
  fields.add(
      "excited_band_hz", [](From one) { return std::pair(one.found->band_low, one.found->band_high); }, "[Hz]");
  fields.add("samples", of(&Found::samples));
  fields.add("experiments", of(&Found::experiments), "segments");
  fields.add("even_clock", of(&Found::even));
  fields.add("sample_time_s", of(&Found::sample_time), "of the data [s]");
  fields.add_number("recorded_rate_hz", of(&Found::recorded_rate_hz), "before decimation [Hz]").only_if([](From one) {
    return one.found->recorded_rate_hz > 0.0;
  });
  fields.add("notes", of(&Found::notes));
  fields.add("warnings", of(&Found::warnings));
  fields.add("usable", of(&Found::usable));
}

struct ReportDocument {
  std::string command, note;
  Document result;

  [[nodiscard]] const SimulatedOutput& drawn() const { return result.findings->drawn; }
};

void describe(Fields<ReportDocument>& fields) {
  const auto drawn = &ReportDocument::drawn;
  fields.type("Transfer function report",
              "Data of the page that `mbk tf --report` writes. Data for display have six digits, times nine.");
  fields.header("mbk.tf_report/1");
  fields.add("command", &ReportDocument::command, "command line");
  fields.add_unless_empty("note", &ReportDocument::note);
  fields.group("simulation", [drawn](Fields<ReportDocument>& part) {
    part.add(
        "held_out", [](const ReportDocument& report) { return report.result.found->held_out_fit.has_value(); },
        "on held-out data");
    part.add_rounded("time_s", through(drawn, &SimulatedOutput::time), document::kTimeDigits, "[s]");
    part.add_rounded("measured", through(drawn, &SimulatedOutput::measured), document::kDigits);
    part.add_rounded("simulated", through(drawn, &SimulatedOutput::simulated), document::kDigits);
  });
  fields.add("result", &ReportDocument::result);
}

}  // namespace

std::string to_json(const TransferFunctionIdentification& found, const TransferFunctionFindings& findings) {
  return document::document(Document{&found, &findings});
}

std::string report_json(const TransferFunctionIdentification& found, const TransferFunctionFindings& findings,
                        const std::string& command, const std::string& note) {
  return document::compact(document::written(ReportDocument{command, note, {&found, &findings}})) + "\n";
}

void add_tf_schemas(document::Schemas& schemas) {
  schemas["tf"] = document::schema_of<Document>();
  schemas["tf_report"] = document::schema_of<ReportDocument>();
}

}  // namespace result
}  // namespace mbk
