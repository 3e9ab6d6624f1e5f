#include "mbk/present/report/trials_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/base/core/table_text.h"
#include "mbk/base/core/version.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/present/report/layout.h"

namespace mbk::report {
namespace trials_table {

/// A number of a trial and its 95 % interval; the interval is undefined where there is none.
struct Quantity {
  std::string name, unit;
  double value = 0;
  Interval interval95 = {std::nan(""), std::nan("")};
};

std::string label_of(const Identification& id) {
  std::vector<std::string> labels;
  for (const SourceFile& source : id.sources) labels.push_back(source.label());
  return fmt::format("{}", fmt::join(labels, "; "));
}

constexpr std::array<const char*, 2> kAxes = {"x", "y"};

/// M, B, K row by row, then x₀, in the order of impedance::stacked.
std::vector<std::pair<std::string, std::string>> parameters_of(int axes, Motion motion) {
  const Units units = units_of(motion);
  const std::size_t n = static_cast<std::size_t>(axes);
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [letter, unit] :
       {std::pair("m", units.inertia), std::pair("b", units.damping), std::pair("k", units.stiffness)}) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        names.emplace_back(n == 1 ? std::string(letter) : fmt::format("{}_{}{}", letter, kAxes[i], kAxes[j]), unit);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) names.emplace_back(n == 1 ? "x0" : fmt::format("{}0", kAxes[i]), units.position);
  return names;
}

void add_ellipses(const Identification& id, const Findings& findings, std::vector<Quantity>& quantities) {
  const Units units = units_of(id.motion);
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const EllipseFinding& finding = findings.ellipses[k];
    const std::string unit = std::array{units.inertia, units.damping, units.stiffness}[k];
    quantities.push_back(
        {fmt::format("{}_area", kMatrixNames[k]), fmt::format("({})²", unit), finding.ellipse.area, finding.area95});
    quantities.push_back({fmt::format("{}_shape", kMatrixNames[k]), "", finding.ellipse.shape, finding.shape95});
    quantities.push_back({fmt::format("{}_orientation", kMatrixNames[k]),
                          "°",
                          kDegrees * finding.ellipse.orientation,
                          {kDegrees * finding.orientation95.first, kDegrees * finding.orientation95.second}});
  }
}

/// What a row shows of a result; of one that is not usable, the fit alone.
std::vector<Quantity> quantities_of(const Measurement& measured) {
  const Identification& id = measured.identification;
  std::vector<Quantity> quantities;
  if (id.usable) {
    const Vector values = impedance::stacked(id.model);
    const Vector half = numeric::kNormal95 * impedance::stacked(id.standard_error);
    const auto names = parameters_of(id.axes, id.motion);
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto i = static_cast<Index>(k);
      quantities.push_back({names[k].first, names[k].second, values[i], {values[i] - half[i], values[i] + half[i]}});
    }
  }
  for (Index i = 0; i < id.fit.vaf.size(); ++i) {
    const char* const name = id.axes == 1 ? "VAF" : (i == 0 ? "VAF_x" : "VAF_y");
    quantities.push_back({name, "%", id.fit.vaf[i]});
  }
  if (id.usable && measured.findings) add_ellipses(id, *measured.findings, quantities);
  return quantities;
}

using Column = std::pair<std::string, std::string>;  // name and unit

/// Those of every result, each once, in the order in which they come; whether any has an interval.
std::vector<std::pair<Column, bool>> columns_of(std::span<const Measurement> measured) {
  std::vector<std::pair<Column, bool>> columns;
  for (const Measurement& one : measured) {
    for (const Quantity& quantity : quantities_of(one)) {
      const Column column(quantity.name, quantity.unit);
      auto found = std::ranges::find(columns, column, &std::pair<Column, bool>::first);
      if (found == columns.end()) found = columns.insert(columns.end(), {column, false});
      found->second = found->second || std::isfinite(quantity.interval95.first);
    }
  }
  return columns;
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string csv_row(const Measurement& measured, const std::vector<std::pair<Column, bool>>& columns) {
  const Identification& id = measured.identification;
  std::vector<std::string_view> codes;
  for (const Warning& warning : id.warnings) codes.push_back(word_of(warning.code));
  std::string row = fmt::format("{},{},{},{},{},{}", csv_field(label_of(id)),
                                id.preparations.empty() ? "" : word_of(id.preparations.front().protocol),
                                word_of(id.method), id.usable ? "usable" : "not usable", fmt::join(codes, " "),
                                id.fit.held_out ? "held-out data" : "the same data");
  const std::vector<Quantity> quantities = quantities_of(measured);
  for (const auto& [column, has_interval] : columns) {
    const auto found =
        std::ranges::find_if(quantities, [&](const Quantity& one) { return Column(one.name, one.unit) == column; });
    const bool there = found != quantities.end();
    row += "," + (there ? number(found->value) : "");
    if (!has_interval) continue;
    row += there ? fmt::format(",{},{}", number(found->interval95.first), number(found->interval95.second)) : ",,";
  }
  return row + "\n";
}

/// "a.mat" of "trials/a.mat": a printed table has no room for folders.
std::string short_label(const Identification& id) {
  std::vector<std::string> labels;
  for (const SourceFile& source : id.sources) {
    const std::string label = source.label();
    labels.push_back(label.substr(std::min(source.path.find_last_of('/') + 1, label.size())));
  }
  return latex_text(fmt::format("{}", fmt::join(labels, "; ")));
}

std::string latex_number(double value, double half) {
  if (!std::isfinite(value)) return "--";
  std::string text = with_interval(value, half);
  const std::string sign = "±";
  if (const std::size_t at = text.find(sign); at != std::string::npos) text.replace(at, sign.size(), "\\pm");
  return "$" + text + "$";
}

std::string latex_cells(const impedance::Model& model, const impedance::Model& half, int axes) {
  const Vector values = impedance::stacked(model), halves = impedance::stacked(half);
  std::string cells;
  for (Index k = 0; k < 3 * axes * axes; ++k) cells += " & " + latex_number(values[k], halves[k]);
  return cells;
}

/// m_xy → $M_{xy}$, as it stands above the unit of its column.
std::string symbol(const std::string& name) {
  const std::string letter(1, static_cast<char>(name.front() - 'a' + 'A'));
  return name.size() == 1 ? "$" + letter + "$" : "$" + letter + "_{" + name.substr(2) + "}$";
}

/// The result whose axes and units the table has: the first.
struct Shape {
  int axes;
  Motion motion;
  [[nodiscard]] bool fits(const Identification& id) const { return id.axes == axes && id.motion == motion; }
};

std::string latex_row(const Measurement& measured, const Shape& shape, int columns) {
  const Identification& id = measured.identification;
  const auto instead = [&](const std::string& why) {
    return fmt::format("{} & \\multicolumn{{{}}}{{l}}{{{}}}", short_label(id), columns, latex_text(why));
  };
  if (!shape.fits(id)) return instead("axes or units differ from those of the first trial");
  if (!id.usable) return instead("not usable");
  impedance::Model half = id.standard_error;
  for (Matrix* const matrix : {&half.M, &half.B, &half.K}) *matrix *= numeric::kNormal95;
  std::string row = short_label(id) + latex_cells(id.model, half, id.axes);
  for (const double vaf : id.fit.vaf) row += std::isfinite(vaf) ? fmt::format(" & {:.1f}", vaf) : " & --";
  return row;
}

std::string latex_header(const Shape& shape) {
  const auto names = parameters_of(shape.axes, shape.motion);
  std::string symbols = "Trial", units;
  for (std::size_t k = 0; k + static_cast<std::size_t>(shape.axes) < names.size(); ++k) {
    symbols += " & " + symbol(names[k].first);
    units += fmt::format(" & [{}]", latex_text(names[k].second));
  }
  for (int i = 0; i < shape.axes; ++i) {
    symbols += shape.axes == 1 ? " & VAF" : fmt::format(" & VAF$_{}$", kAxes[static_cast<std::size_t>(i)]);
    units += " & [\\%]";
  }
  return symbols + " \\\\\n" + units + " \\\\\n";
}

}  // namespace trials_table

std::string trials_csv(std::span<const Measurement> measured, const SeveralTrials& together) {
  using namespace trials_table;
  const auto columns = columns_of(measured);
  std::string text = "file,protocol,method,state,warnings,fit on";
  for (const auto& [column, has_interval] : columns) {
    const std::string unit = column.second.empty() ? "" : fmt::format(" [{}]", column.second);
    text += "," + csv_field(column.first + unit);
    if (!has_interval) continue;
    for (const char* const end : {"low", "high"})
      text += "," + csv_field(fmt::format("{} 95 % {}{}", column.first, end, unit));
  }
  text += "\n";
  for (const Measurement& one : measured) text += csv_row(one, columns);
  std::size_t cells = 0;
  for (const auto& [column, has_interval] : columns) cells += has_interval ? 3 : 1;
  for (const Error& error : together.failed) {
    text += fmt::format("{},,,{},,{}\n", csv_field(error.where), csv_field("failed: " + error.message),
                        std::string(cells, ','));
  }
  return text;
}

std::string trials_latex(std::span<const Measurement> measured, const SeveralTrials& together) {
  using namespace trials_table;
  const Shape shape{measured.empty() ? 2 : measured.front().identification.axes,
                    measured.empty() ? Motion::translation : measured.front().identification.motion};
  const int columns = 3 * shape.axes * shape.axes + shape.axes;
  const bool wide = shape.axes > 1;
  const char* const float_name = wide ? "sidewaystable" : "table";
  std::string text = fmt::format(
      "% Needs \\usepackage{{booktabs}}{}.\n\\begin{{{}}}\n\\centering\n"
      "\\caption{{Impedance of each trial, $\\pm$ the half width of its 95\\,\\% interval; VAF on {} data. mbk {}.}}\n",
      wide ? ", \\usepackage{graphicx} and \\usepackage{rotating}" : "", float_name,
      measured.empty() || measured.front().identification.fit.held_out ? "held-out" : "the same", version());
  if (wide) text += "\\resizebox{\\linewidth}{!}{%\n";
  text += "\\begin{tabular}{l" + std::string(static_cast<std::size_t>(columns), 'r') + "}\n\\toprule\n" +
          latex_header(shape) + "\\midrule\n";
  for (const Measurement& one : measured) text += latex_row(one, shape, columns) + " \\\\\n";
  for (const Error& error : together.failed) {
    text += fmt::format("{} & \\multicolumn{{{}}}{{l}}{{could not be measured}} \\\\\n",
                        latex_text(error.where.substr(error.where.find_last_of('/') + 1)), columns);
  }
  if (together.summary && together.summary->mean.axes() == shape.axes && together.summary->motion == shape.motion) {
    text += fmt::format("\\midrule\nMean of {}{}{} \\\\\n", together.summary->trials,
                        latex_cells(together.summary->mean, together.summary->half_width95, shape.axes),
                        std::string(" & ") + (shape.axes > 1 ? " & " : ""));
  }
  text += "\\bottomrule\n\\end{tabular}";
  return text + (wide ? "}\n" : "\n") + fmt::format("\\end{{{}}}\n", float_name);
}

}  // namespace mbk::report
