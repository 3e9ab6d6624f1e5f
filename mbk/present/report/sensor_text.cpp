#include "mbk/present/report/sensor_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

constexpr double kMilli = 1000.0;
constexpr double kPublishedLoad = 20.0;  ///< [N]: in which Dyck (2013, appendix E) gives the crosstalk

using Row = std::vector<std::string>;

/// Standard errors in half a 95 % interval, of lines with a slope for every axis that is fitted together.
double reach95(const SensorCalibration& c, Index slopes) {
  if (c.continuous) return numeric::kNormal95;
  const Index freedom = static_cast<Index>(c.rows) - slopes - 1;
  return numeric::student_quantile(0.975, static_cast<int>(std::max<Index>(freedom, 1)));
}

double reach95(const SensorCalibration& c) {
  return reach95(c, c.crosstalk.size() > 0 ? c.slope.cols() : 1);
}

/// A row of one cell for each axis.
template <class Cell>
Row row(const char* name, const SensorCalibration& calibration, const char* unit, const Cell& cell) {
  Row cells{name};
  for (std::size_t k = 0; k < calibration.axes.size(); ++k)
    cells.push_back(cell(calibration.axes[k], static_cast<Index>(k)));
  cells.emplace_back(unit);
  return cells;
}

std::string percent_of_full_scale(double value, const SensorAxis& axis) {
  return fmt::format("{:.3g} ({:.2g} %)", value, 100.0 * value / axis.full_scale);
}

std::string slopes(const SensorCalibration& c) {
  Row heading{""};
  for (const SensorAxis& axis : c.axes) heading.push_back("V" + axis.name);
  heading.emplace_back("");
  std::vector<Row> rows{heading};
  for (Index i = 0; i < c.slope.rows(); ++i) {
    Row cells{fmt::format("F{} by", c.axes[static_cast<std::size_t>(i)].name)};
    for (Index j = 0; j < c.slope.cols(); ++j) {
      const bool fitted = i == j || c.crosstalk.size() > 0;
      cells.push_back(fitted ? with_interval(c.slope(i, j), reach95(c) * c.slope_error(i, j)) : "0");
    }
    cells.emplace_back("N/V");
    rows.push_back(std::move(cells));
  }
  return table(rows);
}

std::string qualities(const SensorCalibration& c) {
  Row heading{""};
  for (const SensorAxis& axis : c.axes) heading.push_back(axis.name);
  heading.emplace_back("");
  const auto force_of = [&](double voltage, Index k) { return std::abs(c.slope(k, k)) * voltage; };
  std::vector<Row> rows{
      heading,
      row("zero V0", c, "V",
          [&](const SensorAxis& a, Index) { return with_interval(a.zero_voltage, reach95(c) * a.zero_voltage_error); }),
      row("force at 0 V", c, "N",
          [&](const SensorAxis& a, Index) { return with_interval(a.intercept, reach95(c) * a.intercept_error); }),
      row("R²", c, "", [](const SensorAxis& a, Index) { return fmt::format("{:.6f}", a.r_squared); }),
      row("RMSE", c, "N", [](const SensorAxis& a, Index) { return fmt::format("{:.3g}", a.rmse); }),
      row("largest load", c, "N", [](const SensorAxis& a, Index) { return fmt::format("{:.4g}", a.full_scale); }),
      row("nonlinearity", c, "N", [](const SensorAxis& a, Index) { return percent_of_full_scale(a.nonlinearity, a); }),
      row("hysteresis", c, "N",
          [](const SensorAxis& a, Index) {
            return a.hysteresis ? percent_of_full_scale(*a.hysteresis, a) : "unknown";
          }),
      row("noise at constant load", c, "mV (N)",
          [&](const SensorAxis& a, Index k) {
            return a.noise ? fmt::format("{:.3g} ({:.2g})", kMilli * *a.noise, force_of(*a.noise, k)) : "unknown";
          }),
      row("step", c, "mV (N)",
          [&](const SensorAxis& a, Index k) {
            const auto q = a.resolution();
            return q ? fmt::format("{:.4g} ({:.3g})", kMilli * *q, force_of(*q, k)) : "unknown";
          }),
      row("step/√12", c, "N",
          [&](const SensorAxis& a, Index k) {
            const auto q = a.resolution();
            return q ? fmt::format("{:.2g}", force_of(*q, k) / std::sqrt(12.0)) : "";
          }),
  };
  return table(rows);
}

std::string crosstalk(const SensorCalibration& c) {
  std::string text;
  for (Index j = 0; j < c.crosstalk.rows(); ++j) {
    for (Index i = 0; i < c.crosstalk.cols(); ++i) {
      if (i == j) continue;
      const std::string &on = c.axes[static_cast<std::size_t>(i)].name,
                        &felt = c.axes[static_cast<std::size_t>(j)].name;
      text += paragraph(
          "  crosstalk    ",
          fmt::format(
              "{} shows {} % of a load on {}: {:.3g} N if {} goes from 0 to {:g} N; the slopes above correct it", felt,
              with_interval(100.0 * c.crosstalk(j, i), 100.0 * reach95(c) * c.crosstalk_error(j, i)), on,
              kPublishedLoad * c.crosstalk(j, i), on, kPublishedLoad));
    }
  }
  if (text.empty() && c.axes.size() > 1) text = paragraph("  crosstalk    ", "not fitted: each axis separately");
  return text;
}

std::string published(const SensorCalibration& c) {
  std::string text;
  for (const SensorAxis& axis : c.axes) {
    const ForceOnVoltage& line = axis.published;
    text += paragraph("  as published ",
                      fmt::format("F{0} = ({1}) V{0} + ({2}), R² = {3:.4f}", axis.name,
                                  with_interval(line.slope, reach95(c, 1) * line.slope_error),
                                  with_interval(line.intercept, reach95(c, 1) * line.intercept_error), line.r_squared));
  }
  return text;
}

}  // namespace

std::string sensor_text(const SensorCalibration& c) {
  std::string text;
  for (const SourceFile& source : c.sources) text += fmt::format("{}   {}\n", source.label(), source.format);
  text += paragraph(
      "  data         ",
      c.continuous ? fmt::format("{} samples over time; standard errors allow for residuals correlated over {:g} s",
                                 c.rows, c.hac_lag_s)
                   : fmt::format("{} rows, each an independent load", c.rows));
  for (const std::string& note : c.notes) text += paragraph("  read         ", note);
  text += "\n" + slopes(c) + "\n" + qualities(c) + "\n" + crosstalk(c) + published(c);
  if (c.delay != 0.0) {
    text += paragraph("  delay        ", fmt::format("the voltage lags the load by {:.3g} ms", kMilli * c.delay));
  }
  text += c.lever_arm ? fmt::format("  lever arm    {:g} mm in this calibration\n", kMilli * *c.lever_arm)
                      : paragraph("  lever arm    ",
                                  "not given; state it with --lever-arm-mm to convert to other points of application");
  for (const SensorWarning& warning : c.warnings) {
    text += paragraph("  ! ", fmt::format("{}: {}", word_of(warning.code), warning.message));
    if (!warning.remedy.empty()) text += paragraph("    try: ", warning.remedy);
  }
  return text +
         "\n(±: half of the 95 % interval; the result is the inverted slope of V on F; F on V is for comparison)\n";
}

std::string sensor_delay_text(const MeasuredDelay& found) {
  std::string text;
  for (const SourceFile& source : found.sources) text += fmt::format("{}   {}\n", source.label(), source.format);
  const double half = kMilli * numeric::kNormal95 * found.delay_error;
  text += fmt::format("  data    {:.3g} s; the mass explains {:.2f} % of the force\n", found.duration, found.vaf);
  text += fmt::format("  mass    {:.4g} ± {:.2g} kg, stated {:g} kg\n", found.mass,
                      numeric::kNormal95 * found.mass_error, found.stated_mass);
  text += fmt::format("  delay   {:.2f} ± {:.2f} ms: the force is read {} the motion\n", kMilli * found.delay, half,
                      found.delay < 0.0 ? "before" : "after");
  for (const std::string& problem : found.problems) text += paragraph("  ! ", problem);
  if (!found.usable()) return text + paragraph("  ", "do not use this delay");
  if (std::abs(kMilli * found.delay) <= half) return text + "  no delay between force and motion was detected\n";
  return text +
         fmt::format("  correct it with mbk measure --force-delay-ms {:.2f} ... (±: half of the 95 % interval)\n",
                     kMilli * found.delay);
}

}  // namespace mbk::report
