#include "mbk/present/report/transfer_function_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/present/report/layout.h"
#include "mbk/present/report/picture.h"

namespace mbk::report {
namespace {

using Rows = std::vector<std::vector<std::string>>;

const char* method_text(TransferFunctionMethod method) {
  switch (method) {
    case TransferFunctionMethod::srivc:
      return "refined instrumental variables, continuous time (SRIVC)";
    case TransferFunctionMethod::rivc:
      return "refined instrumental variables, continuous time, with a noise model (RIVC)";
    case TransferFunctionMethod::closed_loop:
      return "refined instrumental variables, continuous time, instruments from the reference (CLSRIVC)";
    case TransferFunctionMethod::output_error:
      return "output error, discrete time (OE)";
    case TransferFunctionMethod::box_jenkins:
      return "Box–Jenkins, discrete time (BJ)";
  }
  return "";
}

std::string hold_text(InputHold hold, bool found) {
  const char* const because = hold == InputHold::zero ? ", as its steps show" : ", as it shows no steps";
  return fmt::format(
      "{}{}",
      hold == InputHold::zero ? "held between samples (zero-order hold)" : "linear between samples (first-order hold)",
      found ? because : "");
}

std::string delay_text(const TransferFunctionIdentification& found) {
  const std::string where = fmt::format("estimated between 0 and {:.4g} s", found.max_delay);
  if (!found.delay_found) {
    return fmt::format("{:.6g} s, the best fit up to {:.4g} s, but unreliable: see the warnings", found.model.delay,
                       found.max_delay);
  }
  if (!found.delay_standard_error) {
    return fmt::format("{:.6g} s, {}; the intervals treat it as known", found.model.delay, where);
  }
  return fmt::format("{} s, {}; the intervals include its uncertainty",
                     with_interval(found.model.delay, numeric::kNormal95 * *found.delay_standard_error), where);
}

std::string name_of(const std::string& channel, const std::string& unit) {
  return unit.empty() ? channel : fmt::format("{} [{}]", channel, unit);
}

/// -6400 s + 1600
std::string polynomial_text(const Vector& coefficients, bool continuous) {
  std::string text;
  const Index n = coefficients.size();
  for (Index i = 0; i < n; ++i) {
    const Index power = continuous ? n - 1 - i : i;
    const double value = coefficients[power];
    if (value == 0.0 && n > 1) continue;
    text += text.empty() ? (value < 0.0 ? "−" : "") : (value < 0.0 ? " − " : " + ");
    const bool one = std::abs(value) == 1.0 && power > 0;
    if (!one) text += fmt::format("{:.5g}", std::abs(value));
    if (power == 0) continue;
    if (!one) text += " ";
    text += continuous ? (power == 1 ? "s" : fmt::format("s^{}", power)) : fmt::format("q^-{}", power);
  }
  return text;
}

std::string fraction_text(const TransferFunction& model) {
  const bool continuous = model.sample_time == 0.0;
  std::string above = polynomial_text(model.numerator, continuous);
  std::string below = polynomial_text(model.denominator, continuous);
  const std::size_t width = std::max(columns(above), columns(below));
  const auto centred = [&](const std::string& text) { return std::string((width - columns(text)) / 2, ' ') + text; };
  std::string line;
  for (std::size_t k = 0; k < width; ++k) line += "─";
  const std::string name = continuous ? "  G(s) = " : "  G(q) = ";
  const std::string indent(columns(name), ' ');
  const std::string delay = model.delay > 0.0 ? fmt::format(" e^(−{:.6g} s)", model.delay) : "";
  return indent + centred(above) + "\n" + name + line + delay + "\n" + indent + centred(below) + "\n";
}

std::string orders_text(const std::vector<OrderChoice>& orders) {
  Rows rows = {{"poles", "zeros", "R_T²", "YIC", "AIC", "BIC", ""}};
  for (const OrderChoice& one : orders) {
    if (!one.usable) {
      rows.push_back({fmt::format("{}", one.poles), fmt::format("{}", one.zeros), "no converged stable model"});
      continue;
    }
    rows.push_back({fmt::format("{}", one.poles), fmt::format("{}", one.zeros), fmt::format("{:.6f}", one.fit),
                    fmt::format("{:.2f}", one.yic), fmt::format("{:.1f}", one.aic), fmt::format("{:.1f}", one.bic),
                    one.chosen ? "chosen" : ""});
  }
  return table(rows) +
         paragraph(
             "  ",
             "Chosen: among the models whose 1 − R_T² is within 2 % of the minimum, the one with the lowest YIC.");
}

std::string coefficients_text(const TransferFunctionIdentification& found) {
  const bool continuous = found.model.sample_time == 0.0;
  const Vector half = numeric::kNormal95 * found.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Index n = found.model.poles(), q = found.model.numerator.size();
  Rows rows;
  for (Index k = q; k-- > 0;) {
    rows.push_back({fmt::format("b{}", k), with_interval(found.model.numerator[k], half[n + k])});
  }
  for (Index k = n; k-- > 0;) {
    const Index at = continuous ? k : n - k;
    rows.push_back({fmt::format("{}{}", continuous ? "a" : "f", at),
                    with_interval(found.model.denominator[at], half[continuous ? k : at - 1])});
  }
  return table(rows) + "  (±: half of the 95 % interval; coefficients in " +
         (continuous ? "seconds and SI units"
                     : fmt::format("SI units, q: shift by {:.6g} ms", 1e3 * found.model.sample_time)) +
         (found.hac_lag_s > 0.0 ? ", for noise correlated over up to " + fmt::format("{:g} s)\n", found.hac_lag_s)
                                : ", for white noise)\n");
}

void add_roots(const char* what, const std::vector<Root>& roots, Rows& rows) {
  for (const Root& root : roots) {
    rows.push_back({root.pair ? fmt::format("{} pair", what) : what,
                    with_interval(root.frequency, numeric::kNormal95 * root.frequency_standard_error) + " Hz",
                    root.pair ? "ζ " + with_interval(root.damping, numeric::kNormal95 * root.damping_standard_error)
                              : fmt::format("{:.5g} 1/s", root.value.real()),
                    root.outside_band ? "outside the excited band" : ""});
  }
}

std::string residual_text(const ResidualTests& tests) {
  Rows rows = {{"residual", fmt::format("{}, p = {:.2g}; {:.0f} % of {} lags beyond the 99 % limit",
                                        tests.white() ? "white noise" : "coloured", tests.whiteness_p,
                                        100.0 * tests.autocorrelation_outside, tests.lags)}};
  rows.push_back({"residual and input", fmt::format("{}, p = {:.2g}; {:.0f} % of the lags beyond the 99 % limit",
                                                    tests.independent() ? "uncorrelated" : "correlated", tests.cross_p,
                                                    100.0 * tests.cross_correlation_outside)});
  return table(rows);
}

std::string starts_text(const TransferFunctionIdentification& found) {
  constexpr double kSame = 1e-6;
  const auto settled = std::ranges::count(found.starts, true, &SearchStart::converged);
  const auto same = std::ranges::count_if(found.starts, [&](const SearchStart& start) {
    return start.converged && std::abs(start.fit - found.fit) <= kSame;
  });
  if (same == std::ssize(found.starts)) {
    return same == 1 ? std::string("1, converged to this model") : fmt::format("{}, all converged to this model", same);
  }
  return fmt::format("{}: {} converged, {} of them to this model", found.starts.size(), settled, same);
}

}  // namespace

std::string transfer_function_text(const TransferFunctionIdentification& found) {
  std::string text;
  for (const SourceFile& source : found.sources) text += fmt::format("{}   {}\n", source.label(), source.format);
  Rows rows = {{"from, to", name_of(found.input, found.input_unit) + " → " + name_of(found.output, found.output_unit)},
               {"method", method_text(found.method)}};
  rows.push_back(
      {"samples",
       fmt::format("{} in {} segment{}, {}", found.samples, found.experiments, found.experiments == 1 ? "" : "s",
                   found.even ? fmt::format("every {:.6g} ms", 1e3 * found.sample_time)
                              : fmt::format("unevenly spaced, about every {:.6g} ms", 1e3 * found.sample_time))});
  if (found.recorded_rate_hz > 0.0) {
    rows.push_back({"decimated", fmt::format("from {:.6g} to {:.6g} Hz, after a low-pass filter",
                                             found.recorded_rate_hz, 1.0 / found.sample_time)});
  }
  if (found.band_high > 0.0) {
    rows.push_back({"excited", fmt::format("{:.3g} to {:.3g} Hz contain 96 % of the power of the input", found.band_low,
                                           found.band_high)});
  }
  rows.push_back({"starts", starts_text(found)});
  if (found.hold) rows.push_back({"input", hold_text(*found.hold, found.hold_found)});
  if (found.max_delay > 0.0) rows.push_back({"delay", delay_text(found)});
  text += table(rows) + "\n";
  if (!found.orders.empty()) text += orders_text(found.orders) + "\n";
  text += fraction_text(found.model) + "\n" + coefficients_text(found) + "\n";
  rows.clear();
  add_roots("pole", found.poles, rows);
  add_roots("zero", found.zeros, rows);
  rows.push_back({"gain at 0 Hz", with_interval(found.gain, numeric::kNormal95 * found.gain_standard_error)});
  text += table(rows) + "\n";
  rows.clear();
  if (found.held_out_fit) {
    rows.push_back({"held out", fmt::format("R² {:.5f}, RMSE {:.4g} {} (simulated)", *found.held_out_fit,
                                            found.held_out_rmse, found.output_unit)});
  }
  rows.push_back({"in sample", fmt::format("R_T² {:.5f}, noise {:.4g} {}, YIC {:.2f}", found.fit,
                                           found.noise_standard_deviation, found.output_unit, found.yic)});
  if (found.noise_numerator.size() > 1) {
    rows.push_back({"noise model", fmt::format("({}) / ({}) ε", polynomial_text(found.noise_numerator, false),
                                               polynomial_text(found.noise_denominator, false))});
  } else if (found.noise_denominator.size() > 1) {
    rows.push_back({"noise model", fmt::format("autoregressive, order {}", found.noise_denominator.size() - 1)});
  }
  text += table(rows) + residual_text(found.residuals);
  for (const std::string& note : found.notes) text += paragraph("  ", note);
  if (!found.warnings.empty()) text += "\n" + warnings_text(found.warnings);
  return text;
}

std::vector<Chart> response_charts(const TransferFunctionIdentification& found, const FrequencyResponse& response) {
  const auto values = [](const Vector& vector) { return std::vector<double>(vector.begin(), vector.end()); };
  const auto line = [&](const char* name, const Vector& x, const Vector& y) {
    return ChartSeries{name, values(x), values(y), {}, ChartSeries::Drawn::line};
  };
  const ChartAxis frequency = {"frequency", "Hz", true};
  const std::string name = name_of(found.input, found.input_unit) + " → " + name_of(found.output, found.output_unit);
  const Vector phase = kDegrees * response.phase, half = kDegrees * response.phase_half_width;
  Chart magnitude{"Magnitude, " + name, frequency, {"output over input", "", true}, {}, {}, {}};
  magnitude.series = {line("model", response.frequency, response.value.cwiseAbs()),
                      line("95 %, low", response.frequency, response.magnitude95.col(0)),
                      line("95 %, high", response.frequency, response.magnitude95.col(1))};
  Chart turn{"Phase, " + name, frequency, {"phase", "°"}, {}, {}, {}};
  turn.series = {line("model", response.frequency, phase), line("95 %, low", response.frequency, phase - half),
                 line("95 %, high", response.frequency, phase + half)};
  for (Chart* const chart : {&magnitude, &turn}) {
    for (const double end : {found.band_low, found.band_high}) {
      if (end >= response.frequency[0] && end <= response.frequency[response.size() - 1]) {
        chart->vertical.push_back({end, "end of the excited band"});
      }
    }
  }
  Chart nyquist{"Nyquist plot, " + name, {"real part", ""}, {"imaginary part", ""}, {}, {}, {}};
  nyquist.series = {line("model", response.value.real(), response.value.imag())};
  nyquist.horizontal = nyquist.vertical = {{0.0, ""}};
  nyquist.equal_scale = true;
  return {magnitude, turn, nyquist};
}

std::string inverted_admittance_text(const InvertedAdmittance& inverse) {
  const Units units = units_of(inverse.motion);
  std::string text =
      fmt::format("\nimpedance, force per velocity: the inverse of force → {}\n", word_of(inverse.output));
  Rows rows;
  const auto add = [&](const char* name, const std::optional<Estimate>& value, const char* unit) {
    if (value)
      rows.push_back({name, with_interval(value->value, numeric::kNormal95 * value->standard_error) + " " + unit});
  };
  add("M", inverse.M, units.inertia);
  add("B", inverse.B, units.damping);
  add("K", inverse.K, units.stiffness);
  if (!rows.empty()) text += table(rows) + "\n";
  const auto polar = [](const FrequencyResponse& response, Index i) {
    return fmt::format("{:.4g} [{:.4g}, {:.4g}]", std::abs(response.value[i]), response.magnitude95(i, 0),
                       response.magnitude95(i, 1));
  };
  rows = {
      {"Hz", fmt::format("|Z| [{}]", units.damping), "Re Z", "phase [°]", fmt::format("|sZ| [{}]", units.stiffness)}};
  constexpr Index kShown = 10;
  const FrequencyResponse& z = inverse.impedance;
  for (Index k = 0; k < kShown; ++k) {
    const Index i = k * (z.size() - 1) / (kShown - 1);
    rows.push_back(
        {fmt::format("{:.3g}", z.frequency[i]), polar(z, i), with_interval(z.value[i].real(), z.real_half_width[i]),
         with_interval(kDegrees * z.phase[i], kDegrees * z.phase_half_width[i]), polar(inverse.stiffness, i)});
  }
  text += table(rows);
  if (inverse.unstable) {
    text += paragraph("  ",
                      "The admittance has zeros in the right half-plane, so this impedance is unstable, which is "
                      "impossible for a limb; use fewer zeros.");
  }
  return text;
}

}  // namespace mbk::report
