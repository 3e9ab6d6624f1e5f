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

/// M, B, K row by row, then x₀, in the order of impedance::stacked.
std::vector<std::pair<std::string, std::string>> parameters_of(int axes, Motion motion) {
  const Units units = units_of(motion);
  const std::size_t n = static_cast<std::size_t>(axes);
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [letter, unit] :
       {std::pair("m", units.inertia), std::pair("b", units.damping), std::pair("k", units.stiffness)}) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        names.emplace_back(n == 1 ? std::string(letter) : fmt::format("{}_{}{}", letter, kAxisNames[i], kAxisNames[j]),
                           unit);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    names.emplace_back(n == 1 ? "x0" : fmt::format("{}0", kAxisNames[i]), units.position);
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

void add_ellipsoids(const Identification& id, const SpatialFindings& findings, std::vector<Quantity>& quantities) {
  const Units units = units_of(id.motion);
  for (std::size_t k = 0; k < kMatrixNames.size(); ++k) {
    const EllipsoidFinding& finding = findings.ellipsoids[k];
    const std::string name = kMatrixNames[k], unit = std::array{units.inertia, units.damping, units.stiffness}[k];
    for (std::size_t i = 0; i < finding.principal.size(); ++i) {
      const PrincipalDirection& one = finding.principal[i];
      quantities.push_back({fmt::format("{}_principal_{}", name, i + 1), unit, one.value, one.value95});
      for (std::size_t j = 0; j < kAxisNames.size(); ++j) {
        quantities.push_back(
            {fmt::format("{}_direction_{}_{}", name, i + 1, kAxisNames[j]), "", one.direction[static_cast<Index>(j)]});
      }
      quantities.push_back({fmt::format("{}_half_angle_{}", name, i + 1), "°", kDegrees * one.half_angle95});
    }
    quantities.push_back(
        {fmt::format("{}_ellipsoid_volume", name), fmt::format("({})³", unit), finding.volume, finding.volume95});
    quantities.push_back({fmt::format("{}_ellipsoid_shape", name), "", finding.shape, finding.shape95});
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
    const std::string name = id.axes == 1 ? "VAF" : fmt::format("VAF_{}", kAxisNames[static_cast<std::size_t>(i)]);
    quantities.push_back({name, "%", id.fit.vaf[i]});
  }
  if (id.usable && measured.findings) add_ellipses(id, *measured.findings, quantities);
  if (id.usable && measured.spatial) add_ellipsoids(id, *measured.spatial, quantities);
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
  return fmt::format("{}", fmt::join(labels, "; "));
}

PaperCell number_cell(double value, double half) {
  if (!std::isfinite(value)) return {"–"};
  return {with_interval(value, half), PaperCell::Kind::number};
}

/// Parameters of a model of one table, in the order of impedance::stacked.
struct Part {
  Index first, count;
};

void add_cells(PaperRow& row, const impedance::Model& model, const impedance::Model& half, const Part& part) {
  const Vector values = impedance::stacked(model), halves = impedance::stacked(half);
  for (Index k = part.first; k < part.first + part.count; ++k) row.cells.push_back(number_cell(values[k], halves[k]));
}

/// m_xy → M_{xy}, as it stands above the unit of its column.
std::string symbol(const std::string& name) {
  const std::string letter(1, static_cast<char>(name.front() - 'a' + 'A'));
  return name.size() == 1 ? letter : letter + "_{" + name.substr(2) + "}";
}

/// The result whose axes and units the table has: the first.
struct Shape {
  int axes;
  Motion motion;
  [[nodiscard]] bool fits(const Identification& id) const { return id.axes == axes && id.motion == motion; }
};

impedance::Model half_width95(const Identification& id) {
  impedance::Model half = id.standard_error;
  for (Matrix* const matrix : {&half.M, &half.B, &half.K}) *matrix *= numeric::kNormal95;
  half.x0 *= numeric::kNormal95;
  return half;
}

PaperRow trial_row(const Measurement& measured, const Shape& shape, const Part& part) {
  const Identification& id = measured.identification;
  PaperRow row{{{short_label(id)}}};
  if (!shape.fits(id) || !id.usable) {
    row.cells.push_back({shape.fits(id) ? "not usable" : "axes or units differ from those of the first trial"});
    return row;
  }
  add_cells(row, id.model, half_width95(id), part);
  for (const double vaf : id.fit.vaf) row.cells.push_back({std::isfinite(vaf) ? fmt::format("{:.1f}", vaf) : "–"});
  return row;
}

std::vector<PaperRow> header_rows(const Shape& shape, const Part& part) {
  const auto names = parameters_of(shape.axes, shape.motion);
  PaperRow symbols{{{"Trial"}}}, units{{{""}}};
  for (const auto& [name, unit] :
       std::span(names).subspan(static_cast<std::size_t>(part.first), static_cast<std::size_t>(part.count))) {
    symbols.cells.push_back({symbol(name), PaperCell::Kind::symbol});
    units.cells.push_back({fmt::format("[{}]", unit)});
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(shape.axes); ++i) {
    symbols.cells.push_back({shape.axes == 1 ? "\\mathrm{VAF}" : fmt::format("\\mathrm{{VAF}}_{}", kAxisNames[i]),
                             PaperCell::Kind::symbol});
    units.cells.push_back({"[%]"});
  }
  return {symbols, units};
}

const char* fit_data(const Identification& id) {
  return id.fit.held_out ? "held-out data" : "the data that were fitted";
}

/// "1.20 \pm 0.03 & … \\ …" row by row.
std::string latex_elements(const Matrix& values, const Matrix& halves) {
  std::string text;
  for (Index i = 0; i < values.rows(); ++i) {
    for (Index j = 0; j < values.cols(); ++j) {
      const std::string cell = latex_cell(number_cell(values(i, j), halves(i, j)));
      text += (j > 0 ? " & " : i > 0 ? " \\\\ " : "") + (cell == "--" ? "\\text{--}" : cell.substr(1, cell.size() - 2));
    }
  }
  return text;
}

/// M, B, K and x₀ of one trial as equations, then the fit in a sentence.
std::string trial_latex(const Identification& id) {
  const std::string label = latex_text(short_label(id));
  if (!id.usable) {
    std::vector<std::string_view> codes;
    for (const Warning& warning : id.warnings) codes.push_back(word_of(warning.code));
    return fmt::format("\\noindent {}: not usable ({}).\n", label,
                       latex_text(fmt::format("{}", fmt::join(codes, ", "))));
  }
  const Units units = units_of(id.motion);
  const impedance::Model half = half_width95(id);
  std::string text = "% Needs \\usepackage{amsmath}.\n\\begin{align*}\n";
  const auto add = [&](const char* matrix, const char* scalar, const Matrix& values, const Matrix& halves,
                       const std::string& unit, const char* end) {
    const std::string elements = latex_elements(values, halves);
    text += id.axes == 1 ? fmt::format("{} &= ({})", scalar, elements)
                         : fmt::format("{} &= \\begin{{bmatrix}} {} \\end{{bmatrix}}", matrix, elements);
    text += fmt::format("\\ \\text{{{}}}{}\n", latex_text(unit), end);
  };
  add("\\mathbf{M}", "M", id.model.M, half.M, units.inertia, " \\\\");
  add("\\mathbf{B}", "B", id.model.B, half.B, units.damping, " \\\\");
  add("\\mathbf{K}", "K", id.model.K, half.K, units.stiffness, " \\\\");
  add("\\mathbf{x}_0", "x_0", id.model.x0, half.x0, units.position, "");
  std::vector<std::string> fits;
  for (Index i = 0; i < id.fit.vaf.size(); ++i) {
    const std::string axis = id.axes == 1 ? "" : fmt::format(" along ${}$", kAxisNames[static_cast<std::size_t>(i)]);
    fits.push_back(fmt::format("{:.1f}\\,\\%{}", id.fit.vaf[i], axis));
  }
  return text + fmt::format(
                    "\\end{{align*}}\n\\noindent {}, $\\pm$ the half width of the 95\\,\\% interval. VAF on {}: {}. "
                    "mbk {}.\n",
                    label, fit_data(id), fmt::join(fits, ", "), version());
}

PaperTable parameter_table(std::span<const Measurement> measured, const SeveralTrials& together, const Shape& shape,
                           const Part& part, const char* of) {
  PaperTable table;
  table.sideways = shape.axes > 1;
  table.alignment = "l" + std::string(static_cast<std::size_t>(part.count + shape.axes), 'r');
  table.caption = fmt::format("{} of each trial, ± the half width of its 95 % interval", of);
  if (!measured.empty()) table.caption += fmt::format("; VAF on {}", fit_data(measured.front().identification));
  table.caption += fmt::format(". mbk {}.", version());
  table.header = header_rows(shape, part);
  for (const Measurement& one : measured) table.rows.push_back(trial_row(one, shape, part));
  for (const Error& error : together.failed) {
    table.rows.push_back({{{error.where.substr(error.where.find_last_of('/') + 1)}, {"could not be measured"}}});
  }
  if (together.summary && together.summary->mean.axes() == shape.axes && together.summary->motion == shape.motion) {
    PaperRow mean{{{fmt::format("Mean of {}", together.summary->trials)}}, true};
    add_cells(mean, together.summary->mean, together.summary->half_width95, part);
    for (int i = 0; i < shape.axes; ++i) mean.cells.push_back({""});
    table.rows.push_back(std::move(mean));
  }
  return table;
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
  if (measured.size() == 1 && together.failed.empty()) return trial_latex(measured.front().identification);
  const Shape shape{measured.empty() ? 2 : measured.front().identification.axes,
                    measured.empty() ? Motion::translation : measured.front().identification.motion};
  const Index size = Index{shape.axes} * shape.axes;
  if (shape.axes < 3) return latex_table(parameter_table(measured, together, shape, {0, 3 * size}, "Impedance"));
  std::string text;  // a table for each matrix, as 27 columns fit on no page
  for (const auto& [of, first] :
       {std::pair("Inertia", Index{0}), std::pair("Damping", size), std::pair("Stiffness", 2 * size)}) {
    text += (text.empty() ? "" : "\n") + latex_table(parameter_table(measured, together, shape, {first, size}, of));
  }
  return text;
}

}  // namespace mbk::report
