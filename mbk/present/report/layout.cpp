#include "mbk/present/report/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/core/ordinal.h"
#include "mbk/present/report/picture.h"
#include "mbk/present/report/text.h"

namespace mbk::report {

std::string with_interval(double value, double half_width) {
  if (!std::isfinite(value)) return "undefined";
  if (!std::isfinite(half_width)) return fmt::format("{:.4g}", value);
  if (!(half_width > 0.0)) return fmt::format("{:.6g}", value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(half_width))), 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f}", value, decimals, half_width, decimals);
}

std::string direction_text(const Vector& direction) {
  std::string text;
  for (const double one : direction) {
    text += fmt::format("{}{:5.2f}", text.empty() ? "" : " ", std::round(100.0 * one) / 100.0 + 0.0);  // no -0
  }
  return text;
}

std::string paragraph(std::string_view first, std::string_view text) {
  const std::size_t indent = columns(first);
  std::string lines(first);
  for (const char c : wrapped(text, kLineColumns - indent)) {
    lines += c;
    if (c == '\n') lines.append(indent, ' ');
  }
  return lines + "\n";
}

std::string table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], columns(row[k]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
      line += row[k];
      line.append(widths[k] - columns(row[k]) + 2, ' ');
    }
    constexpr std::size_t kNarrowest = 40;
    if (!row.empty() && columns(line) + kNarrowest < kLineColumns) {
      line = paragraph(line, row.back());
      line.pop_back();
    } else if (!row.empty()) {
      line += row.back();
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    text += line + "\n";
  }
  return text;
}

std::string warnings_text(const std::vector<Warning>& warnings) {
  std::string text;
  for (const Warning& warning : warnings) {
    text += paragraph("  ! ", fmt::format("{}: {}", word_of(warning.code), warning.message));
    text += paragraph("    try: ", warning.remedy);
  }
  return text;
}

std::string filters_text(const Preparation& how) {
  std::string filters = fmt::format("Savitzky–Golay N {} W {}", how.smoothing_order, how.smoothing_window);
  filters += how.cutoff ? fmt::format(", then zero-phase Butterworth {:.3g} Hz: {}", how.cutoff->value, how.cutoff_rule)
                        : ", no low-pass";
  if (how.every > 1) filters += fmt::format("; every {} sample", ordinal(how.every));
  return filters;
}

}  // namespace mbk::report
