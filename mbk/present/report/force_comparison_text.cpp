#include "mbk/present/report/force_comparison_text.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// With that number of decimals, never "-0"; a dash if undefined.
std::string cell(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  const double unit = std::pow(10.0, decimals);
  return fmt::format("{:.{}f}", std::round(unit * value) / unit + 0.0, decimals);
}

std::string axis_name(Index axis, Index axes) {
  return axes == 1 ? "F" : fmt::format("F{}", kAxisNames[static_cast<std::size_t>(axis)]);
}

}  // namespace

std::string force_comparison_text(const ForceComparison& comparison, std::string_view estimated,
                                  std::string_view measured, std::string_view unit) {
  const Index axes = comparison.vaf.size();
  std::string text = fmt::format("{} against {}, {:.1f} s\n", estimated, measured, comparison.duration);

  Rows together = {{"", fmt::format("RMS in {}", unit), fmt::format("RMSE in {}", unit), "VAF in %", "gain",
                    "correlation", "delay in ms"}};
  for (Index axis = 0; axis < axes; ++axis) {
    together.push_back({axis_name(axis, axes), cell(comparison.measured_rms[axis], 2),
                        cell(comparison.all.rmse[axis], 3), cell(comparison.vaf[axis], 2),
                        cell(comparison.gain[axis], 3), cell(comparison.correlation[axis], 4),
                        cell(kMilliseconds * comparison.lag[axis], 1)});
  }
  text += table(together);

  const std::string in_unit = fmt::format(" in {}", unit);
  const bool narrow = axes > 2;  // otherwise wider than a terminal
  Rows apart = {{"", "share in %"}};
  for (const char* const quantity : {"bias", "RMSE"}) {
    for (Index axis = 0; axis < axes; ++axis)
      apart[0].push_back(fmt::format("{} {}{}", quantity, axis_name(axis, axes), narrow ? "" : in_unit));
  }
  const auto add = [&](const char* name, const ForceAgreement& part) {
    const double share = 100.0 * static_cast<double>(part.rows) / static_cast<double>(comparison.all.rows);
    std::vector<std::string> row = {name, cell(share, 0)};
    for (const double bias : part.bias) row.push_back(cell(bias, 3));
    for (const double rmse : part.rmse) row.push_back(cell(rmse, 3));
    apart.push_back(std::move(row));
  };
  add("at rest", comparison.rest);
  add("in motion", comparison.motion);
  add("at reversals", comparison.reversals);
  add("all", comparison.all);
  text += "\n" + table(apart);
  text += paragraph(
      "  ",
      fmt::format("bias{}: mean of the first minus the second; at rest: at most {:g} rad/s (m/s for sliding joints); "
                  "reversals: within {:g} ms of a reversal of a joint; RMS: of the second about its mean",
                  narrow ? " and RMSE" + in_unit + "; bias" : "", comparison.rest_speed,
                  kMilliseconds * comparison.reversal_window));
  return text;
}

}  // namespace mbk::report
