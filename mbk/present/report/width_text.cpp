#include "mbk/present/report/width_text.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace {

std::string between(double value, const Interval& interval) {
  constexpr double kRounding = 1e-12;  // of results that are equal
  if (std::abs(value) < kRounding) value = 0.0;
  if (!std::isfinite(interval.first) || !std::isfinite(interval.second)) return fmt::format("{:.3g}", value);
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", value, interval.first, interval.second);
}

std::string times(const WidthRatio& ratio, bool directed) {
  const std::string text = "× " + between(ratio.ratio, ratio.ratio95);
  return directed ? text + fmt::format(" at {:.0f}°", 180.0 / std::numbers::pi * ratio.direction) : text;
}

}  // namespace

std::string width_text(const WidthFindings& widths) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;
  bool directed = false, spatial = false;
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const char* const name = kMatrixNames[k];
    if (!widths.of[k]) {
      notes.push_back(fmt::format("{} has no width: {}", name, widths.refused[k]));
      continue;
    }
    const WidthFinding& one = *widths.of[k];
    directed = one.ratios.size() == 2;
    spatial = one.ratios.size() == 3;
    const WidthRatio &least = one.ratios.front(), &most = one.ratios.back();
    rows.push_back({name, between(one.distance, one.distance95), times(least, directed)});
    if (directed) rows.back().push_back(times(most, directed));
    if (spatial) rows.back().push_back(direction_text(least.along));
    rows.back().emplace_back(one.distinguishable ? "" : "not distinct");
    if (spatial) rows.push_back({"", "", times(most, false), direction_text(most.along), ""});
    if (!one.surely_positive) {
      notes.push_back(
          fmt::format("{}: a smallest eigenvalue is not significantly above zero, so the width has no upper limit: do "
                      "not trust the interval",
                      name));
    }
  }
  std::string text;
  if (!rows.empty()) {
    std::vector<std::string> heading = {"", "width", "ratio second/first", ""};
    if (directed) heading = {"", "width", "ratio second/first, minimum", "maximum", ""};
    if (spatial) heading = {"", "width", "ratio second/first, min and max", "direction x, y, z", ""};
    rows.insert(rows.begin(), std::move(heading));
    text += table(rows);
    text += paragraph("  ",
                      "(width: overall difference, 0 = equal, √(Σ ln² λ) of Z₁⁻¹Z₂, symmetric parts; brackets are 95 % "
                      "intervals. Noise alone gives a "
                      "width above 0: interpret it only if both matrices are well identified)");
  }
  for (const std::string& note : notes) text += paragraph("  ! ", note);
  return text;
}

}  // namespace mbk::report
