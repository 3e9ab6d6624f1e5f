#include "mbk/present/report/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/significant.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/force_comparison_text.h"
#include "mbk/present/report/joint_domain_text.h"
#include "mbk/present/report/layout.h"
#include "mbk/present/report/passivity_text.h"
#include "mbk/present/report/picture.h"

namespace mbk::report {
namespace {

std::string range(const Interval& interval, int decimals, double scale = 1.0) {
  if (!std::isfinite(interval.first) || !std::isfinite(interval.second)) return "";
  constexpr double kLargest = 1e7;
  if (scale * std::max(std::abs(interval.first), std::abs(interval.second)) >= kLargest) {
    return fmt::format("[{:.3g}, {:.3g}]", scale * interval.first, scale * interval.second);
  }
  return fmt::format("[{:.{}f}, {:.{}f}]", scale * interval.first, decimals, scale * interval.second, decimals);
}

std::string per_axis(const Vector& values, std::string_view unit, int decimals) {
  const auto number = [&](double value) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "undefined";
  };
  if (values.size() == 1) return fmt::format("{} {}", number(values[0]), unit);
  std::string text;
  for (Index i = 0; i < values.size(); ++i) {
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", kAxisNames[static_cast<std::size_t>(i)], number(values[i]));
  }
  return fmt::format("{} {}", text, unit);
}

std::string inputs_line(const Identification& id) {
  std::string text;
  for (std::size_t i = 0; i < id.sources.size(); ++i) {
    text += fmt::format("{}   {:.1f} s at {:.6g} Hz   {}\n", id.sources[i].label(), id.durations[i], id.rates[i],
                        id.sources[i].format);
  }
  return text;
}

std::string how_made(const Identification& id) {
  if (id.preparations.empty()) return "";  // a result that was read back
  const Preparation& how = id.preparations.front();
  std::vector<std::vector<std::string>> rows;
  constexpr std::size_t kNotes = 4;
  for (std::size_t k = 0; k < std::min(id.notes.size(), kNotes); ++k) rows.push_back({"read", id.notes[k]});
  if (id.notes.size() > kNotes) {
    rows.push_back({"", fmt::format("and {} more notes: see 'mbk info'", id.notes.size() - kNotes)});
  }
  rows.push_back({"mode", how.mode == Mode::reference
                              ? fmt::format("reference, {} of the published procedure", word_of(how.procedure))
                              : "default"});
  rows.push_back({"method", fmt::format("{}{}", method_name(id.method),
                                        id.method_rule.empty() ? "" : fmt::format(" ({})", id.method_rule))});
  rows.push_back({"protocol", fmt::format("{} ({})", word_of(how.protocol), how.protocol_rule)});
  rows.push_back({"window", how.window_rule});
  rows.push_back({"filters", filters_text(how)});
  if (how.force_source != ForceSource::sensor) {
    rows.push_back({"force", how.force_source == ForceSource::observer
                                 ? "momentum observer, from motion, torques and a model of the robot"
                                 : "virtual sensor, from motion, torques and a model of the robot"});
  }
  rows.push_back(
      {"acceleration", how.acceleration_from_sensor ? "from the accelerometer" : "second derivative of position"});
  std::string data = fmt::format("{:.1f} s", id.excitation.duration);
  data += id.parameters_from == ParametersFrom::all ? ", the whole analysed interval" : "";
  if (id.preparations.size() > 1) data += fmt::format(", {} trials pooled", id.preparations.size());
  rows.push_back({"parameters", data});
  const Excitation& e = id.excitation;
  const bool metres = id.motion == Motion::translation;
  std::string motion =
      fmt::format("{:.3g} {} rms", metres ? 1e3 * e.motion : e.motion, metres ? "mm" : units_of(id.motion).position);
  if (id.axes > 1) {
    motion += fmt::format(
        ", {:.0f} % as much {}", 100.0 * e.motion_ratio,
        id.axes == 2 ? "across the main direction as along it" : "in the weakest direction as in the strongest");
  }
  rows.push_back({"motion", motion + fmt::format("; condition number {}", significant(e.condition, 2))});
  if (id.handle_mass > 0.0) {
    const bool recorded = id.handle_mass_from == HandleMassSource::recording;
    rows.push_back({"handle mass", fmt::format("{:g} kg subtracted from the inertia, {}", id.handle_mass,
                                               recorded ? "as stated in the recording" : "as given")});
  } else if (how.mode == Mode::reference && how.procedure == Procedure::chapter5) {
    rows.push_back({"handle mass", "none subtracted (the published handle of 0.135 kg: --handle-mass 0.135)"});
  } else {
    rows.push_back({"handle mass", "none subtracted"});
  }
  if (id.structure != Structure::full) rows.push_back({"structure", std::string(word_of(id.structure))});
  return table(rows);
}

std::string model_table(const impedance::Model& model, const impedance::Model& spread, double factor, Motion motion) {
  const Index n = model.axes();
  const Units units = units_of(motion);
  std::vector<std::vector<std::string>> rows;
  if (n == 2) rows.push_back({"", "xx", "xy", "yx", "yy", ""});
  if (n == 3) rows.push_back({"", "", "x", "y", "z", ""});
  const std::array<std::pair<const char*, Matrix impedance::Model::*>, 3> parts = {
      {{"inertia M", &impedance::Model::M},
       {"damping B", &impedance::Model::B},
       {"stiffness K", &impedance::Model::K}}};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    std::vector<std::string> row = {parts[k].first};
    for (Index j = 0; j < n; ++j) {
      if (n == 3) row.emplace_back(kAxisNames[static_cast<std::size_t>(j)]);
      for (Index i = 0; i < n; ++i) {
        row.push_back(with_interval((model.*parts[k].second)(j, i), factor * (spread.*parts[k].second)(j, i)));
      }
      if (n < 3 && j + 1 < n) continue;  // in one row
      row.push_back(std::array{units.inertia, units.damping, units.stiffness}[k]);
      rows.push_back(std::exchange(row, {""}));
    }
  }
  std::vector<std::string> equilibrium = {n == 1 ? "equilibrium x0" : "equilibrium"};
  if (n == 3) equilibrium.emplace_back();
  for (Index j = 0; j < n; ++j) {
    const std::string axis =
        n == 2 ? std::string(kAxisNames[static_cast<std::size_t>(j)]) + " " : "";  // n = 3: heading
    const double scale = n == 1 ? 1.0 : 1e3;
    equilibrium.push_back(axis + with_interval(scale * model.x0[j], scale * factor * spread.x0[j]));
  }
  if (n == 2) equilibrium.insert(equilibrium.end(), {"", ""});
  equilibrium.push_back(n == 1 ? units.position : "mm");
  rows.push_back(std::move(equilibrium));
  return table(rows);
}

/// Two, or enough decimals for four digits of values below ten.
int decimals_of(const ValidationRow& row) {
  double largest = 0.0;
  const auto [low, high] = row.interval95.value_or(Interval(row.value, row.value));
  for (const double value : {row.value, low, high}) {
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  }
  if (!(largest > 0.0)) return 2;
  return std::clamp(3 - static_cast<int>(std::floor(std::log10(largest))), 2, 9);
}

/// An interval with possibly infinite ends.
std::string validation_range(const Interval& interval, int decimals) {
  const auto end = [&](double value) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : value < 0.0 ? "-inf" : "inf";
  };
  if (!std::isfinite(interval.first) && !std::isfinite(interval.second)) return "unbounded";
  return fmt::format("[{}, {}]", end(interval.first), end(interval.second));
}

/// "rows: 20 met, 1 falls short, 3 not shown, 4 informative".
std::string counted(const std::vector<ValidationRow>& rows) {
  std::vector<std::string> parts;
  for (const auto& [verdict, word] : word_table(RowVerdict{})) {
    const auto count = std::ranges::count(rows, verdict, &ValidationRow::verdict);
    if (count > 0) parts.push_back(fmt::format("{} {}", count, word));
  }
  return fmt::format("rows: {}", fmt::join(parts, ", "));
}

std::string expected_text(const Interval& expected) {
  if (!std::isfinite(expected.second)) return fmt::format("at least {:g}", expected.first);
  if (!std::isfinite(expected.first)) return fmt::format("at most {:g}", expected.second);
  return fmt::format("[{:g}, {:g}]", expected.first, expected.second);
}

std::string source_line(const SourceFile& source) {
  return fmt::format("{}   {}{}\n", source.label(), source.format,
                     source.sha256.empty() ? "" : fmt::format("   sha256 {}…", source.sha256.substr(0, 16)));
}

/// "3: GO 0.512 s, HIT 1.204 s, STOP 2 s"
std::string events_text(const std::vector<Event>& events) {
  constexpr std::size_t kShown = 12;
  std::vector<std::string> shown;
  for (const Event& event : std::span(events).first(std::min(kShown, events.size()))) {
    shown.push_back(fmt::format("{} {:.6g} s", event.name, event.time));
  }
  return fmt::format("{}: {}{}", events.size(), fmt::join(shown, ", "),
                     events.size() > kShown ? fmt::format(" and {} more", events.size() - kShown) : "");
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t width) {
  std::string lines;
  std::size_t used = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (used > 0 && used + 1 + columns(word) > width) {
      lines += '\n';
      used = 0;
    } else if (used > 0) {
      lines += ' ';
      ++used;
    }
    lines += word;
    used += columns(word);
  }
  return lines;
}

std::string ellipses_text(const Findings& findings) {
  std::vector<std::vector<std::string>> rows = {{"ellipse", "area", "shape", "orientation", "antisymmetry"}};
  std::vector<EllipsePanel> panels;
  const double degrees = 180.0 / std::numbers::pi;
  const Units units = units_of(Motion::translation);
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const EllipseFinding& finding = findings.ellipses[k];
    const impedance::Ellipse& e = finding.ellipse;
    panels.push_back({e, kMatrixNames[k], std::array{units.inertia, units.damping, units.stiffness}[k]});
    std::vector<std::string> row = {kMatrixNames[k]};
    if (e.lambda_min > 0.0) {
      const int decimals = e.area < 100.0 ? 2 : 0;
      row.push_back(fmt::format("{:.{}f} {}", e.area, decimals, range(finding.area95, decimals)));
      row.push_back(fmt::format("{:.2f} {}", e.shape, range(finding.shape95, 2)));
    } else {
      row.push_back(fmt::format("none (λ {:.3g}, {:.3g})", e.lambda_min, e.lambda_max));
      row.emplace_back();
    }
    row.push_back(finding.round
                      ? "any: may be a circle"
                      : fmt::format("{:.1f}° {}", degrees * e.orientation, range(finding.orientation95, 1, degrees)));
    if (k != 1) {
      const AntisymmetryFinding& a = findings.antisymmetry[k == 0 ? 0 : 1];
      row.push_back(std::isfinite(a.zmean_percent) ? fmt::format("{:.1f} % {}", a.zmean_percent, range(a.zmean95, 1))
                                                   : "undefined");
    }
    rows.push_back(std::move(row));
  }
  return table(rows) + "  (area: squared unit of the matrix; antisymmetry: z_mean; brackets: 95 % intervals)\n\n" +
         draw_ellipses(panels);
}

namespace {

/// To two digits of the interval's half width: "412 [398, 426]".
std::string with_range(double value, const Interval& interval) {
  if (!std::isfinite(value)) return "undefined";
  const double half = 0.5 * (interval.second - interval.first);
  if (!(half > 0.0) || !std::isfinite(half)) return fmt::format("{:.4g}", value);
  constexpr double kLargest = 1e5;
  if (std::abs(value) >= kLargest) {
    return fmt::format("{:.3g} [{:.3g}, {:.3g}]", value, interval.first, interval.second);
  }
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(half))), 0, 9);
  return fmt::format("{:.{}f} {}", value, decimals, range(interval, decimals));
}

}  // namespace

std::string ellipsoids_text(const SpatialFindings& findings) {
  const Units units = units_of(Motion::translation);
  const std::array<const char*, 3> unit = {units.inertia, units.damping, units.stiffness};
  std::vector<std::vector<std::string>> axes = {{"ellipsoid", "principal value", "direction x, y, z", "within"}};
  std::vector<std::vector<std::string>> sizes = {{"", "volume", "shape"}};
  std::vector<std::vector<std::string>> circulations = {{"antisymmetric", "size", "z_mean", "direction x, y, z"}};
  constexpr double kAnyDegrees = 90.0 * (1.0 - 1e-12);
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const EllipsoidFinding& finding = findings.ellipsoids[k];
    for (const PrincipalDirection& one : finding.principal) {
      const double degrees = kDegrees * one.half_angle95;
      const bool any = degrees >= kAnyDegrees;
      axes.push_back({&one == &finding.principal.front() ? kMatrixNames[k] : "",
                      fmt::format("{} {}", with_range(one.value, one.value95), unit[k]),
                      any ? "any: may equal another" : direction_text(one.direction),
                      any || std::isnan(degrees) ? "" : fmt::format("{:.1f}°", degrees)});
    }
    if (finding.closed) {
      sizes.push_back(
          {kMatrixNames[k], with_range(finding.volume, finding.volume95), with_range(finding.shape, finding.shape95)});
    } else {
      sizes.push_back({kMatrixNames[k], "not positive beyond its interval", ""});
    }
    if (k == 1) continue;
    const CirculationFinding& a = findings.antisymmetry[k == 0 ? 0 : 1];
    circulations.push_back({kMatrixNames[k], fmt::format("{} {}", with_range(a.size, a.size95), unit[k]),
                            std::isfinite(a.percent) ? fmt::format("{:.1f} %", a.percent) : "undefined",
                            a.significant  ? direction_text(a.vector.normalized())
                            : a.size > 0.0 ? "not significant (95 %)"
                                           : "imposed by the structure"});
  }
  return table(axes) + "\n" + table(sizes) + "\n" + table(circulations) +
         paragraph("  ",
                   "(principal values of the symmetric part; within: half-angle of the cone that contains the true "
                   "direction; volume: cubed unit of the matrix; shape: largest over smallest; antisymmetric part: "
                   "(Z − Zᵀ)/2 · u = a × u, here size and direction of a; brackets: 95 % intervals)");
}

/// Effect of two errors that one recording cannot show: F + e shifts x₀ by K⁻¹ e, and F(t − τ) lowers B by τ K.
std::string unseen(const Identification& id) {
  const Vector stretched = numeric::singular_values(id.model.K);
  const Units units = units_of(id.motion);
  const bool metres = id.motion == Motion::translation;
  const double moved = 1.0 / stretched[stretched.size() - 1];
  return paragraph(
      "  ", fmt::format("(one recording cannot reveal: an offset of 1 {} in the force would shift x0 by "
                        "up to {} {}; a delay of the force by 1 ms would lower B by up to {} {})",
                        units.force, significant(metres ? 1e3 * moved : moved, 2), metres ? "mm" : units.position,
                        significant(1e-3 * stretched[0], 2), units.damping));
}

std::string result_text(const Identification& id, const std::optional<Findings>& findings,
                        const std::optional<SpatialFindings>& spatial) {
  std::string text = inputs_line(id) + how_made(id) + "\n";
  if (id.usable) {
    text += model_table(id.model, id.standard_error, numeric::kNormal95, id.motion);
    text += "  (±: half of the 95 % interval; M ẍ + B ẋ + K (x − x0) = −F, F: force of the limb on the machine)\n";
    text += unseen(id) + "\n";
  }
  text += table({{id.fit.held_out ? "fit on held-out data" : "fit on the same data",
                  "VAF " + per_axis(id.fit.vaf, "%", 2), "RMSE " + per_axis(id.fit.rmse, units_of(id.motion).force, 3)},
                 {"fit in sample", "VAF " + per_axis(id.fit.vaf_in_sample, "%", 2)}});
  if (id.standard_error_of_robot && id.usable) {
    const impedance::Model& of_robot = *id.standard_error_of_robot;
    const Units units = units_of(id.motion);
    text += table({{"± from the robot model",
                    fmt::format("M {:.2g} {}, B {:.2g} {}, K {:.2g} {}", numeric::kNormal95 * of_robot.M.maxCoeff(),
                                units.inertia, numeric::kNormal95 * of_robot.B.maxCoeff(), units.damping,
                                numeric::kNormal95 * of_robot.K.maxCoeff(), units.stiffness)}});
  }
  if (id.decimation) {
    text += table({{fmt::format("at {:g} Hz", id.decimation->rate_hz),
                    fmt::format("the model differs by {:.2g} % of each matrix's largest element",
                                100.0 * id.decimation->largest_change)}});
  }
  if (findings && id.usable) text += "\n" + ellipses_text(*findings);
  if (spatial && id.usable) text += "\n" + ellipsoids_text(*spatial);
  if (!id.warnings.empty()) text += "\n" + warnings_text(id.warnings);
  if (!id.usable) {
    text += "\n  NOT USABLE: no model is shown; see the warnings above. --json contains its numbers.\n";
  }
  return text;
}

std::string alternative_text(const Identification& id, const Identification& alternative,
                             const Disagreement& disagreement) {
  const bool by_instruments = id.method == Method::instrumental_variables;
  const Identification& instrumental = by_instruments ? id : alternative;
  const auto model = [&] {
    return fmt::format("  by {}, VAF {}\n", method_name(alternative.method), per_axis(alternative.fit.vaf, "%", 1)) +
           model_table(alternative.model, alternative.standard_error, numeric::kNormal95, alternative.motion);
  };
  if (!instrumental.usable || !instrumental.instrument->strong()) {
    std::string why = "the result is not usable";
    for (const Warning& warning : instrumental.warnings) {
      if (warning.code == WarningCode::weak_instruments || warning.code == WarningCode::invalid_instruments) {
        why = warning.message;
      }
    }
    const std::string invalid = paragraph(
        "  ", "instrumental variables gave no usable result, so they cannot be compared with least squares: " + why);
    return by_instruments && alternative.usable
               ? invalid + model() + (alternative.warnings.empty() ? "" : "\n" + warnings_text(alternative.warnings))
               : invalid;
  }
  const char* const unit = unit_of_parameter(disagreement.parameter, id.motion);
  const std::string largest =
      fmt::format("{}: {:.3g} {} by least squares, {:.3g} ± {:.2g} {} ({:.2g} %) {} by instrumental variables",
                  disagreement.parameter, disagreement.least_squares, unit, std::abs(disagreement.difference),
                  numeric::kNormal95 * disagreement.standard_error, unit,
                  100.0 * std::abs(disagreement.difference / disagreement.least_squares),
                  disagreement.difference > 0.0 ? "more" : "less");
  if (!disagreement.significant) {
    return paragraph(
        "  ", fmt::format("the two methods do not differ significantly (99 %); largest difference, {}", largest));
  }
  return paragraph("  ", fmt::format("least squares and instrumental variables DIFFER significantly (99 %); largest "
                                     "difference, {}. The limb or noise acts back on the motion, which biases least "
                                     "squares towards the negative robot impedance. Instrumental variables use only "
                                     "the motion that follows the known reference and are not biased in this way",
                                     largest)) +
         (alternative.usable
              ? model()
              : fmt::format("  {}: the model is not usable and not shown\n", method_name(alternative.method)));
}

std::string by_sensor_text(const Identification& computed, const Identification& sensed,
                           const ForceComparison& comparison) {
  const bool virtual_sensor = computed.preparations.front().force_source == ForceSource::virtual_sensor;
  std::string text =
      force_comparison_text(comparison, virtual_sensor ? "virtual sensor" : "momentum observer", "force sensor");
  text += fmt::format("\n  with the force sensor, VAF {}\n", per_axis(sensed.fit.vaf, "%", 2));
  text += model_table(sensed.model, sensed.standard_error, numeric::kNormal95, sensed.motion);
  const impedance::Model &a = computed.model, &b = sensed.model;
  const Index n = a.axes();
  const impedance::Model undefined =
      impedance::unstacked(Vector::Constant(3 * n * n + n, std::numeric_limits<double>::quiet_NaN()), n);
  text += "  difference: computed force minus force sensor\n";
  return text + model_table({a.M - b.M, a.B - b.B, a.K - b.K, a.x0 - b.x0}, undefined, 1.0, computed.motion);
}

std::string bootstrap_text(const BootstrapFindings& bootstrap) {
  std::vector<std::vector<std::string>> rows = {{"95 % intervals", "value", "bootstrap", "delta method", "unit"}};
  const auto shown = [](const Interval& interval, double scale) {
    if (!std::isfinite(interval.first) || !std::isfinite(interval.second)) return std::string("undefined");
    return fmt::format("[{:.4g}, {:.4g}]", scale * interval.first, scale * interval.second);
  };
  for (const BootstrapFinding& finding : bootstrap.findings) {
    const bool angle = finding.name.ends_with("orientation");
    const double scale = angle ? 180.0 / std::numbers::pi : 1.0;
    rows.push_back({finding.name, fmt::format("{:.4g}", scale * finding.value), shown(finding.interval95, scale),
                    shown(finding.delta95, scale), angle ? "°" : finding.unit});
  }
  return table(rows) + fmt::format("  ({} replicates from blocks of {:g} s; the data contain {:.0f} blocks; seed {})\n",
                                   bootstrap.replicates, bootstrap.block_s, bootstrap.blocks, bootstrap.seed);
}

std::string measurement_text(const Measurement& measured) {
  const Identification& id = measured.identification;
  std::string text = result_text(id, measured.findings, measured.spatial);
  if (measured.alternative && measured.disagreement) {
    text += "\n" + alternative_text(id, *measured.alternative, *measured.disagreement);
  }
  if (id.usable) {
    if (measured.force_comparison && measured.by_sensor) {
      text += "\n" + by_sensor_text(id, *measured.by_sensor, *measured.force_comparison);
    }
    if (measured.joints) text += "\n" + joint_domain_text(*measured.joints);
    if (measured.bootstrap) text += "\n" + bootstrap_text(*measured.bootstrap);
  }
  if (measured.passivity) text += "\n" + passivity_lines(*measured.passivity);
  return text;
}

std::string summary_text(const SeveralTrials& together) {
  if (!together.summary) return paragraph("no mean: ", together.no_summary);
  const Summary& summary = *together.summary;
  const std::size_t all = static_cast<std::size_t>(summary.trials) + summary.omitted.size();
  std::string text =
      fmt::format("mean of {}{} trials, by {}\n", summary.trials,
                  summary.omitted.empty() ? "" : fmt::format(" of {}", all), method_name(summary.method)) +
      model_table(summary.mean, summary.half_width95, 1.0, summary.motion) +
      "  (±: half of the 95 % interval of the mean, from the differences between trials with Student's t)\n";
  for (const OmittedTrial& one : summary.omitted)
    text += paragraph("  omitted  ", fmt::format("{}: {}", one.file, one.why));
  return text;
}

std::string info_text(const Recording& recording, const Inspection& inspection) {
  std::string text;
  for (const SourceFile& source : recording.sources) {
    text += source_line(source);
  }
  std::vector<std::vector<std::string>> rows;
  rows.push_back({"samples", fmt::format("{}, {:.3f} s", inspection.samples, inspection.duration)});
  if (std::isfinite(inspection.rate_hz)) {
    rows.push_back(
        {"rate",
         fmt::format("{:.6g} Hz{}", inspection.rate_hz,
                     recording.time_from_rate ? " (time from the given rate; the file contains no time)" : "")});
    const std::string shortest = fmt::format("{:.4g}", 1e3 * inspection.interval_min),
                      longest = fmt::format("{:.4g}", 1e3 * inspection.interval_max);
    rows.push_back({"clock", fmt::format("intervals {} ms, standard deviation {:.2g} ms",
                                         shortest == longest ? shortest : shortest + " to " + longest,
                                         1e3 * inspection.interval_standard_deviation)});
  } else {
    rows.push_back({"rate", "undefined: time never increases"});
  }
  text += table(rows) + "\n";
  rows = {{"channel", "unit", "from", "to", ""}};
  for (const ChannelFacts& facts : inspection.channels) {
    std::string remark;
    if (facts.constant) {
      remark = "constant";
    } else if (facts.updates.staleness == Staleness::held) {
      remark = fmt::format("! updated at {:.4g} Hz", facts.update_hz);
    } else if (!facts.stale.empty()) {
      remark = fmt::format("! {:.2g} % of the samples are repeated or constant values, not measurements",
                           100.0 * facts.updates.share);
    } else if (facts.clipped) {
      remark = "! repeatedly stays at its extreme value: clipped?";
    }
    rows.push_back(
        {facts.name, facts.unit, fmt::format("{:.6g}", facts.min), fmt::format("{:.6g}", facts.max), remark});
  }
  text += table(rows);
  if (!recording.events.empty()) text += "\n" + paragraph("  events  ", events_text(recording.events));

  std::vector<std::string> problems;
  const auto times = [](Index count) { return count == 1 ? std::string("once") : fmt::format("{} times", count); };
  if (inspection.duplicated_times > 0) {
    problems.push_back(fmt::format("time repeats {}, first at sample {}", times(inspection.duplicated_times),
                                   inspection.first_duplicated + 1));
  }
  if (inspection.backward_times > 0) {
    problems.push_back(fmt::format("time runs backwards {}, first at sample {}", times(inspection.backward_times),
                                   inspection.first_backward + 1));
  }
  constexpr std::size_t kShown = 5;
  Index missing = 0;
  for (std::size_t k = 0; k < inspection.missing.size(); ++k) {
    const MissingSamples& gap = inspection.missing[k];
    missing += gap.count;
    if (k >= kShown) continue;
    problems.push_back(fmt::format("{} missing (NaN in every channel) from sample {} on ({:.3f} s)",
                                   gap.count == 1 ? "a sample is" : fmt::format("{} samples are", gap.count),
                                   gap.first + 1, gap.time));
  }
  if (inspection.missing.size() > kShown) {
    problems.push_back(
        fmt::format("and {} more; {} samples are missing in all", inspection.missing.size() - kShown, missing));
  }
  for (const NonFinite& bad : inspection.non_finite) {
    if (bad.channel != "time" && bad.count == missing) continue;  // reported already
    problems.push_back(
        fmt::format("{} is not a number {}, first at sample {}", bad.channel, times(bad.count), bad.first + 1));
  }
  for (std::size_t k = 0; k < inspection.gaps.size() && k < kShown; ++k) {
    const Gap& gap = inspection.gaps[k];
    problems.push_back(
        fmt::format("a gap of {:.4g} s after sample {} ({:.3f} s)", gap.length, gap.sample + 1, gap.time));
  }
  if (inspection.gaps.size() > kShown)
    problems.push_back(fmt::format("and {} more gaps", inspection.gaps.size() - kShown));
  if (inspection.interval_standard_deviation > 0.01 * inspection.interval_median && inspection.gaps.empty()) {
    problems.push_back("the clock jitters by more than 1 % of its interval");
  }
  for (const ChannelFacts& facts : inspection.channels) {
    if (!facts.stale.empty()) problems.push_back(facts.stale);
  }
  if (!std::isfinite(inspection.rate_hz)) problems.emplace_back("the sample rate cannot be determined from the time");
  text += problems.empty() ? "\n  no gaps, no significant jitter, time increases\n" : "\n";
  for (const std::string& problem : problems) text += paragraph("  ! ", problem);
  for (const std::string& note : recording.notes) text += paragraph("  note: ", note);
  if (!recording.metadata.empty()) {
    rows.clear();
    for (const auto& [key, value] : recording.metadata) rows.push_back({key, value});
    text += "\n" + table(rows);
  }
  return text;
}

std::string trials_text(const std::string& file, const std::vector<std::pair<std::string, std::string>>& trials) {
  std::vector<std::vector<std::string>> rows = {{"trial", ""}};
  for (const auto& [name, description] : trials) rows.push_back({name, description});
  return fmt::format("{}   {} trials; select one with --trial\n", file, trials.size()) + table(rows);
}

std::string contents_text(const FileContents& contents, const Error& unrecognised) {
  std::string text = source_line(contents.source);
  const bool units = std::ranges::any_of(contents.arrays, [](const StoredArray& array) { return !array.unit.empty(); });
  std::vector<std::vector<std::string>> rows = {{contents.table ? "column" : "", contents.table ? "name" : "variable",
                                                 "size", "from", "to", units ? "unit" : ""}};
  for (std::size_t k = 0; k < contents.arrays.size(); ++k) {
    const StoredArray& array = contents.arrays[k];
    const auto number = [](double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "none"; };
    rows.push_back({contents.table ? std::to_string(k + 1) : "", array.name,
                    array.shape.empty() ? fmt::format("{}×{}", array.rows, array.columns)
                                        : fmt::format("{}", fmt::join(array.shape, "×")),
                    number(array.minimum), number(array.maximum), array.unit});
  }
  text += table(rows) + "\n" + paragraph("  ! ", unrecognised.message.substr(0, unrecognised.message.find(';')));
  if (!unrecognised.remedy.empty()) text += paragraph("    try: ", unrecognised.remedy);
  for (const std::string& note : contents.notes) text += paragraph("  note: ", note);
  return text;
}

Chart workspace_chart(const robot::Workspace& workspace, const std::optional<robot::Posture>& posture) {
  Chart chart;
  chart.title = "Workspace of the hand";
  chart.x = {"x", "mm"};
  chart.y = {"y", "mm"};
  chart.equal_scale = true;
  const auto add = [](ChartSeries& series, const Eigen::Vector2d& place) {
    series.x.push_back(kMillimetres * place.x());
    series.y.push_back(kMillimetres * place.y());
  };
  ChartSeries outline{"workspace", {}, {}, {}, ChartSeries::Drawn::line};
  for (const Eigen::Vector2d& place : workspace.outline) add(outline, place);
  ChartSeries base{"base (both motors)", {0.0}, {0.0}, {}, ChartSeries::Drawn::marks};
  chart.series = {outline, base};
  if (posture) {
    ChartSeries links{"links", {}, {}, {}, ChartSeries::Drawn::line};
    add(links, Eigen::Vector2d::Zero());
    add(links, robot::elbow_position(workspace.geometry, posture->theta));
    add(links, posture->hand);
    ChartSeries hand{"hand", {}, {}, {}, ChartSeries::Drawn::marks};
    add(hand, posture->hand);
    chart.series.push_back(links);
    chart.series.push_back(hand);
  }
  return chart;
}

std::string workspace_text(const robot::Workspace& workspace, const std::optional<robot::Posture>& posture) {
  const double degrees = 180.0 / std::numbers::pi;
  const robot::Geometry& geometry = workspace.geometry;
  const robot::JointLimits& limits = geometry.limits;
  std::string text = chart_text(workspace_chart(workspace, posture)) + "\n";
  text += table(
      {{"links", fmt::format("d₁ {:.4g} mm, d₂ {:.4g} mm", 1e3 * geometry.d1, 1e3 * geometry.d2)},
       {"limits", fmt::format("{:.4g}° ≤ θ₁ ≤ {:.4g}°, {:.4g}° ≤ θ₂ ≤ {:.4g}°, θ₁ − (θ₂ − 90°) ≥ {:.4g}°",
                              degrees * limits.theta1_low, degrees * limits.theta1_high, degrees * limits.theta2_low,
                              degrees * limits.theta2_high, degrees * limits.smallest_opening)},
       {"x", fmt::format("{:.1f} to {:.1f} mm", 1e3 * workspace.low.x(), 1e3 * workspace.high.x())},
       {"y", fmt::format("{:.1f} to {:.1f} mm", 1e3 * workspace.low.y(), 1e3 * workspace.high.y())},
       {"area", fmt::format("{:.4f} m²", workspace.area)}});
  if (!posture) return text;
  const impedance::Ellipse felt = impedance::ellipse(posture->inertia_at_hand);
  const Eigen::Matrix2d& J = posture->jacobian;
  text += fmt::format("\nwith the hand at ({:g}, {:g}) mm\n", 1e3 * posture->hand.x(), 1e3 * posture->hand.y());
  text +=
      table({{"joint angles",
              fmt::format("θ₁ {:.2f}°, θ₂ {:.2f}°", degrees * posture->theta[0], degrees * posture->theta[1])},
             {"Jacobian", fmt::format("[{:.4f} {:.4f}; {:.4f} {:.4f}] m", J(0, 0), J(0, 1), J(1, 0), J(1, 1))},
             {"manipulability", fmt::format("|det J| = {:.4f} m²", posture->manipulability)},
             {"inertia at hand", fmt::format("{:.3g} to {:.3g} kg, maximum along {:.1f}° from x (J⁻ᵀ I J⁻¹, table A.1)",
                                             felt.lambda_min, felt.lambda_max, degrees * felt.orientation)}});
  text += "\n";
  std::vector<std::vector<std::string>> rows = {{"limit", "is", "left"}};
  for (const robot::Margin& margin : posture->margins) {
    rows.push_back({fmt::format("{} {} {:.4g}°", margin.quantity, margin.upper ? "≤" : "≥", degrees * margin.limit),
                    fmt::format("{:.2f}°", degrees * margin.value), fmt::format("{:.2f}°", degrees * margin.left())});
  }
  return text + table(rows);
}

std::string validation_text(const ValidationTable& validation) {
  const auto any = [&](auto member) {
    return std::ranges::any_of(validation.rows, [&](const ValidationRow& row) { return (row.*member).has_value(); });
  };
  const bool spread = any(&ValidationRow::spread);
  std::vector<std::vector<std::string>> rows(1);
  rows[0] = {"", validation.unit, "95 % interval"};
  if (spread) rows[0].emplace_back("spread of runs");
  rows[0].insert(rows[0].end(), {"expected", ""});
  for (const ValidationRow& row : validation.rows) {
    const int decimals = decimals_of(row);
    std::vector<std::string> cells = {row.what, fmt::format("{:.{}f}", row.value, decimals),
                                      row.interval95 ? validation_range(*row.interval95, decimals) : ""};
    if (!std::isfinite(row.value)) cells[1] = "undefined";
    if (row.unit && !row.unit->empty()) cells[1] += " " + *row.unit;
    if (spread) cells.push_back(row.spread ? fmt::format("{:.{}f}", *row.spread, decimals) : "");
    cells.push_back(row.expected ? expected_text(*row.expected) : "");
    cells.emplace_back(row.verdict() == RowVerdict::falls_short ? "FALLS SHORT" : word_of(row.verdict()));
    rows.push_back(std::move(cells));
  }
  std::string text = paragraph(validation.study + ": ", validation.question) +
                     fmt::format("{} runs, seed {}\n", validation.runs, validation.seed) + table(rows) +
                     counted(validation.rows) + "\n";
  for (const std::string& note : validation.notes) text += paragraph("  ", note);
  for (const Chart& chart : validation.charts) text += "\n" + chart_text(chart);
  return text;
}

}  // namespace mbk::report
