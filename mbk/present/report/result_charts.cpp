#include "mbk/present/report/result_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "mbk/base/numeric/dense.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace result_charts {

std::vector<double> numbers_of(const Vector& values) {
  return {values.begin(), values.end()};
}

ChartSeries line(std::string name, const Vector& x, const Vector& y) {
  return {std::move(name), numbers_of(x), numbers_of(y), {}, ChartSeries::Drawn::line};
}

std::string with_axis(const std::string& name, Index axis, Index axes) {
  return axes == 1 ? name : name + " " + kAxisNames[static_cast<std::size_t>(axis)];
}

Chart titled(std::string title, ChartAxis x, ChartAxis y) {
  Chart chart;
  chart.title = std::move(title);
  chart.x = std::move(x);
  chart.y = std::move(y);
  return chart;
}

/// The curve that the force draws when a unit motion goes once round.
Chart ellipse_chart(const EllipseFinding& finding, const char* name, const std::string& unit) {
  constexpr int kPoints = 181;
  Chart chart = titled(fmt::format("Ellipse of {}", name), {"along x", unit}, {"along y", unit});
  ChartSeries curve{name, {}, {}, {}, ChartSeries::Drawn::line};
  for (int k = 0; k < kPoints; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / (kPoints - 1);
    const Vector force = finding.symmetric * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    curve.x.push_back(force[0]);
    curve.y.push_back(force[1]);
  }
  chart.series = {std::move(curve)};
  chart.horizontal = {{0.0, ""}};
  chart.vertical = {{0.0, ""}};
  chart.equal_scale = true;
  const std::string orientation =
      finding.round ? "any: may be a circle"
                    : fmt::format("{:.1f}°, {:.1f} to {:.1f}°", kDegrees * finding.ellipse.orientation,
                                  kDegrees * finding.orientation95.first, kDegrees * finding.orientation95.second);
  chart.notes = {fmt::format("shape {:.2f}, 95 % interval {:.2f} to {:.2f}; orientation {}", finding.ellipse.shape,
                             finding.shape95.first, finding.shape95.second, orientation)};
  return chart;
}

void add_ellipses(const Measurement& measured, std::vector<NamedChart>& charts) {
  const Units units = units_of(Motion::translation);
  const std::array<const char*, 3> unit = {units.inertia, units.damping, units.stiffness};
  std::vector<Chart> all;
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const EllipseFinding& finding = measured.findings->ellipses[k];
    if (!(finding.ellipse.lambda_min > 0.0)) continue;
    all.push_back(ellipse_chart(finding, kMatrixNames[k], unit[k]));
    charts.push_back({fmt::format("{}-ellipse", kMatrixNames[k]), all.back()});
  }
  if (all.size() < 2) return;
  NamedChart figure{"ellipses", all.front(), {all.begin() + 1, all.end()}};
  figure.chart.title = "Ellipses side by side";
  charts.push_back(std::move(figure));
}

/// Two axes of a plane.
struct Plane {
  Index across, up;
  [[nodiscard]] std::string name() const {
    return fmt::format("{}{}", kAxisNames[static_cast<std::size_t>(across)], kAxisNames[static_cast<std::size_t>(up)]);
  }
};

/// Outline of the projection of {S u : |u| = 1} onto a plane: the ellipse {C^½ v : |v| = 1}, C = P S Sᵀ Pᵀ, with the
/// two rows of S that the projection P leaves.
Chart projection_chart(const EllipsoidFinding& finding, const Plane& plane, const char* name, const std::string& unit) {
  constexpr int kPoints = 181;
  Chart chart = titled(fmt::format("Ellipsoid of {}, projected onto the {} plane", name, plane.name()),
                       {fmt::format("along {}", kAxisNames[static_cast<std::size_t>(plane.across)]), unit},
                       {fmt::format("along {}", kAxisNames[static_cast<std::size_t>(plane.up)]), unit});
  Matrix left(2, 3);
  left << finding.symmetric.row(plane.across), finding.symmetric.row(plane.up);
  const auto [squares, axes] = numeric::symmetric_eigen(left * left.transpose());
  const Matrix root = axes * squares.cwiseSqrt().asDiagonal() * axes.transpose();
  ChartSeries curve{name, {}, {}, {}, ChartSeries::Drawn::line};
  for (int k = 0; k < kPoints; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / (kPoints - 1);
    const Vector force = root * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    curve.x.push_back(force[0]);
    curve.y.push_back(force[1]);
  }
  chart.series = {std::move(curve)};
  chart.horizontal = {{0.0, ""}};
  chart.vertical = {{0.0, ""}};
  chart.equal_scale = true;
  chart.notes = {fmt::format("shape in space {:.2f}, 95 % interval {:.2f} to {:.2f}", finding.shape,
                             finding.shape95.first, finding.shape95.second)};
  return chart;
}

/// Of each ellipsoid that is closed its three projections, each alone and side by side.
void add_ellipsoids(const SpatialFindings& findings, std::vector<NamedChart>& charts) {
  const Units units = units_of(Motion::translation);
  const std::array<const char*, 3> unit = {units.inertia, units.damping, units.stiffness};
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const EllipsoidFinding& finding = findings.ellipsoids[k];
    if (!finding.closed) continue;
    std::vector<Chart> all;
    for (const Plane& plane : {Plane{0, 1}, Plane{0, 2}, Plane{1, 2}}) {
      all.push_back(projection_chart(finding, plane, kMatrixNames[k], unit[k]));
      charts.push_back({fmt::format("{}-ellipsoid-{}", kMatrixNames[k], plane.name()), all.back()});
    }
    NamedChart figure{fmt::format("{}-ellipsoid", kMatrixNames[k]), all.front(), {all.begin() + 1, all.end()}};
    figure.chart.title = fmt::format("Projections of the ellipsoid of {}", kMatrixNames[k]);
    charts.push_back(std::move(figure));
  }
}

void add_prediction(const ForcePrediction& prediction, const Units& units, std::vector<NamedChart>& charts) {
  const Index axes = prediction.measured.cols();
  for (Index i = 0; i < axes && prediction.time.size() > 0; ++i) {
    Chart chart = titled(with_axis("Measured and predicted force", i, axes), {"time", "s"}, {"force", units.force});
    chart.series = {line("measured", prediction.time, prediction.measured.col(i)),
                    line("predicted by the model", prediction.time, prediction.predicted.col(i))};
    chart.notes = {prediction.held_out ? "held-out (validation) data"
                                       : "the data used for fitting: none were held out"};
    charts.push_back({axes == 1 ? "force" : fmt::format("force-{}", kAxisNames[static_cast<std::size_t>(i)]), chart});
  }
}

void add_autocorrelation(const Autocorrelation& residual, std::vector<NamedChart>& charts) {
  if (residual.lag.size() == 0) return;
  Chart chart = titled("Autocorrelation of the residual", {"lag", "s"}, {"autocorrelation", ""});
  for (Index i = 0; i < residual.value.cols(); ++i) {
    chart.series.push_back(line(with_axis("residual", i, residual.value.cols()), residual.lag, residual.value.col(i)));
  }
  chart.horizontal = {{residual.white95, "white noise, 95 %"}, {-residual.white95, ""}};
  charts.push_back({"residual", std::move(chart)});
}

void add_spectra(const Spectra& spectra, const Units& units, std::vector<NamedChart>& charts) {
  if (spectra.frequency.size() == 0) return;
  const ChartAxis frequency{"frequency", "Hz", true};
  const Index axes = spectra.force.cols();
  Chart coherence = titled("Coherence of force and motion", frequency, {"coherence", ""});
  Chart power = titled("Power spectral density of the force", frequency,
                       {"power spectral density", fmt::format("({})²/Hz", units.force), true});
  for (Index i = 0; i < axes; ++i) {
    coherence.series.push_back(line(with_axis("force", i, axes), spectra.frequency, spectra.coherence.col(i)));
    power.series.push_back(line(with_axis("force", i, axes), spectra.frequency, spectra.force.col(i)));
    if (spectra.residual.size() > 0) {
      power.series.push_back(line(with_axis("residual", i, axes), spectra.frequency, spectra.residual.col(i)));
    }
  }
  coherence.horizontal = {{spectra.coherence_significant, "chance, 95 %"}};
  charts.push_back({"coherence", std::move(coherence)});
  charts.push_back({"force-spectrum", std::move(power)});
}

std::string response_name(const FrequencyResponseEstimate& found, std::size_t input, std::size_t output) {
  return fmt::format("{} → {}", found.inputs[input].name, found.outputs[output].name);
}

std::string response_unit(const FrequencyResponseEstimate& found) {
  const SignalLabel &input = found.inputs.front(), &output = found.outputs.front();
  return input.unit.empty() || output.unit.empty() ? "" : fmt::format("{}/{}", output.unit, input.unit);
}

/// Without jumps of a whole turn from one frequency to the next.
Vector phase_of(const FrequencyResponseEstimate& found, Index i, Index j) {
  Vector phase(found.size());
  for (Index k = 0; k < found.size(); ++k) {
    phase[k] = std::arg(found.response[static_cast<std::size_t>(k)](i, j));
    if (k > 0) phase[k] = phase[k - 1] + std::remainder(phase[k] - phase[k - 1], 2.0 * std::numbers::pi);
  }
  return phase;
}

void add_frequency_response(const FrequencyResponseEstimate& found, std::vector<NamedChart>& charts) {
  const ChartAxis frequency{"frequency", "Hz", true};
  Chart magnitude = titled("Frequency response, magnitude", frequency, {"magnitude", response_unit(found), true});
  Chart phase = titled("Frequency response, phase", frequency, {"phase", "°"});
  Chart coherence = titled("Coherence", frequency, {"coherence", ""});
  for (std::size_t j = 0; j < found.inputs.size(); ++j) {
    for (std::size_t i = 0; i < found.outputs.size(); ++i) {
      const auto entry = static_cast<Index>(i + j * found.outputs.size());
      Vector size(found.size());
      for (Index k = 0; k < found.size(); ++k) {
        size[k] = std::abs(found.response[static_cast<std::size_t>(k)](static_cast<Index>(i), static_cast<Index>(j)));
      }
      const Vector angle = kDegrees * phase_of(found, static_cast<Index>(i), static_cast<Index>(j));
      magnitude.series.push_back(line(response_name(found, j, i), found.frequency, size));
      phase.series.push_back(line(response_name(found, j, i), found.frequency, angle));
      for (Index k = 0; k < found.size(); ++k) {
        magnitude.series.back().intervals.emplace_back(found.magnitude_low(k, entry), found.magnitude_high(k, entry));
        const double half = kDegrees * found.phase_half_width(k, entry);
        phase.series.back().intervals.emplace_back(angle[k] - half, angle[k] + half);
      }
    }
  }
  for (Index i = 0; i < found.multiple_coherence.cols(); ++i) {
    coherence.series.push_back(
        line(found.outputs[static_cast<std::size_t>(i)].name, found.frequency, found.multiple_coherence.col(i)));
  }
  for (Chart* const chart : {&magnitude, &phase}) chart->notes = {"bars are 95 % intervals, for " + found.assumes};
  charts.push_back({"response-magnitude", std::move(magnitude)});
  charts.push_back({"response-phase", std::move(phase)});
  if (!coherence.series.empty()) charts.push_back({"response-coherence", std::move(coherence)});
}

/// Entry (i, j) of an n×n matrix as a label: "xy"; nothing where there is one axis.
std::string entry_name(Index i, Index j, Index axes) {
  return axes == 1
             ? ""
             : fmt::format(" {}{}", kAxisNames[static_cast<std::size_t>(i)], kAxisNames[static_cast<std::size_t>(j)]);
}

/// Column i + j n of `values` is entry (i, j).
std::vector<ChartSeries> entries(const std::string& name, const Vector& at, const Matrix& values, const Matrix& half,
                                 Index axes) {
  std::vector<ChartSeries> series;
  for (Index i = 0; i < axes; ++i) {
    for (Index j = 0; j < axes; ++j) {
      const Index column = i + j * axes;
      series.push_back(line(name + entry_name(i, j, axes), at, values.col(column)));
      for (Index k = 0; k < at.size(); ++k) {
        series.back().intervals.emplace_back(values(k, column) - half(k, column), values(k, column) + half(k, column));
      }
    }
  }
  return series;
}

}  // namespace result_charts

std::vector<NamedChart> measurement_charts(const Measurement& measured, const std::optional<Diagnostics>& diagnostics) {
  using namespace result_charts;
  const Identification& id = measured.identification;
  const Units units = units_of(id.motion);
  std::vector<NamedChart> charts;
  if (id.usable && measured.findings) add_ellipses(measured, charts);
  if (id.usable && measured.spatial) add_ellipsoids(*measured.spatial, charts);
  if (!diagnostics) return charts;
  add_prediction(diagnostics->prediction, units, charts);
  add_autocorrelation(diagnostics->autocorrelation, charts);
  add_spectra(diagnostics->spectra, units, charts);
  return charts;
}

std::vector<NamedChart> exploration_charts(const Exploration& found) {
  using namespace result_charts;
  const Units units = units_of(found.motion);
  std::vector<NamedChart> charts;
  if (found.frequency_response) add_frequency_response(*found.frequency_response, charts);
  if (found.impulse_response) {
    const ImpulseResponseEstimate& response = *found.impulse_response;
    Chart chart =
        titled("Impulse response from motion to force", {"lag", "s"},
               {"response", found.other_signals ? "" : fmt::format("{}/({}·s)", units.force, units.position)});
    chart.series = entries("response", response.lag, response.response, response.half_width, response.axes);
    chart.notes = {"bars are 95 % intervals"};
    charts.push_back({"impulse-response", std::move(chart)});
  }
  if (found.time_course && found.time_course->changes) {
    const TimeCourseEstimate& course = *found.time_course;
    Chart chart =
        titled("Stiffness over " + course.variable, {course.variable, course.unit}, {"stiffness", units.stiffness});
    chart.series = entries("stiffness", course.at, course.K.value, course.K.half_width, course.axes);
    chart.notes = {"bars are 95 % intervals"};
    charts.push_back({"stiffness-course", std::move(chart)});
  }
  return charts;
}

}  // namespace mbk::report
