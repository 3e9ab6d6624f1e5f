#include "mbk/base/core/table_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <span>
#include <utility>

namespace mbk {
namespace {

using Replacement = std::pair<std::string_view, std::string_view>;

constexpr auto kLatex = std::to_array<Replacement>({{" %", "\\,\\%"},
                                                    {"&", "\\&"},
                                                    {"%", "\\%"},
                                                    {"$", "\\$"},
                                                    {"#", "\\#"},
                                                    {"_", "\\_"},
                                                    {"{", "\\{"},
                                                    {"}", "\\}"},
                                                    {"~", "\\~{}"},
                                                    {"^", "\\^{}"},
                                                    {"\\", "\\textbackslash{}"},
                                                    {"·", "$\\cdot$"},
                                                    {"×", "$\\times$"},
                                                    {"²", "$^2$"},
                                                    {"°", "$^\\circ$"},
                                                    {"±", "$\\pm$"},
                                                    {"−", "$-$"},
                                                    {"–", "--"}});

constexpr auto kLatexNumber = std::to_array<Replacement>({{"±", "\\pm"}});

constexpr auto kMarkdown = std::to_array<Replacement>(
    {{"\\", "\\\\"}, {"|", "\\|"}, {"*", "\\*"}, {"_", "\\_"}, {"`", "\\`"}, {"<", "\\<"}, {"$", "\\$"}, {"\n", " "}});

constexpr auto kMarkdownNumber = std::to_array<Replacement>({{"-", "−"}});

std::string with_replacements(std::string_view text, std::span<const Replacement> replacements) {
  std::string made;
  while (!text.empty()) {
    const auto found =
        std::ranges::find_if(replacements, [&](const Replacement& one) { return text.starts_with(one.first); });
    const std::size_t taken = found == replacements.end() ? 1 : found->first.size();
    made += found == replacements.end() ? text.substr(0, 1) : found->second;
    text.remove_prefix(taken);
  }
  return made;
}

std::string markdown_cell(const PaperCell& cell) {
  switch (cell.kind) {
    case PaperCell::Kind::text:
      return with_replacements(cell.text, kMarkdown);
    case PaperCell::Kind::number:
      return with_replacements(cell.text, kMarkdownNumber);
    case PaperCell::Kind::symbol:
      break;
  }
  return "$" + cell.text + "$";
}

std::string markdown_row(std::vector<std::string> cells, std::size_t columns) {
  cells.resize(columns);
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

}  // namespace

bool is_formula(std::string_view text) {
  if (text.empty() || std::string_view("=+-@\t\r\n").find(text.front()) == std::string_view::npos) return false;
  const std::string_view digits = text.substr(text.front() == '+' ? 1 : 0);
  double number = 0.0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return code != std::errc() || end != digits.data() + digits.size();
}

std::string csv_field(std::string_view text) {
  const char* const before = is_formula(text) ? "'" : "";
  if (text.find_first_of(",;\t\"\r\n") == std::string_view::npos) return before + std::string(text);
  std::string quoted = std::string("\"") + before;
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string latex_text(std::string_view text) {
  return with_replacements(text, kLatex);
}

std::string latex_cell(const PaperCell& cell) {
  switch (cell.kind) {
    case PaperCell::Kind::text:
      return latex_text(cell.text);
    case PaperCell::Kind::number:
      return "$" + with_replacements(cell.text, kLatexNumber) + "$";
    case PaperCell::Kind::symbol:
      break;
  }
  return "$" + cell.text + "$";
}

namespace {

std::string latex_rows(const std::vector<PaperRow>& rows, std::size_t columns) {
  std::string text;
  for (const PaperRow& row : rows) {
    if (row.rule_above) text += "\\midrule\n";
    // After the \\\\ of the row above, LaTeX would take "[" or "*" as its argument.
    if (!row.cells.empty() && (row.cells[0].text.starts_with('[') || row.cells[0].text.starts_with('*'))) text += "{}";
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      const bool spans = k + 1 == row.cells.size() && k + 1 < columns;
      const std::string cell = latex_cell(row.cells[k]);
      text += k > 0 ? " & " : "";
      text += spans ? fmt::format("\\multicolumn{{{}}}{{l}}{{{}}}", columns - k, cell) : cell;
    }
    text += " \\\\\n";
  }
  return text;
}

}  // namespace

std::string latex_table(const PaperTable& table) {
  const char* const name = table.sideways ? "sidewaystable" : "table";
  const std::size_t columns = table.alignment.size();
  std::string text = fmt::format("% Needs \\usepackage{{booktabs}}{} and \\usepackage{{graphicx}}.\n",
                                 table.sideways ? ", \\usepackage{rotating}" : "");
  text += fmt::format("\\begin{{{}}}\n\\centering\n\\caption{{{}}}\n", name, latex_text(table.caption));
  text += "\\setlength{\\tabcolsep}{4pt}%\n\\resizebox{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}{!}{%\n";
  text += "\\begin{tabular}{@{}" + table.alignment + "@{}}\n\\toprule\n" + latex_rows(table.header, columns) +
          "\\midrule\n" + latex_rows(table.rows, columns) + "\\bottomrule\n\\end{tabular}}\n";
  if (!table.note.empty()) {
    text += "\\par\\smallskip\n\\begin{minipage}{\\linewidth}\\footnotesize\n\\textit{Note.} " +
            latex_text(table.note) + "\n\\end{minipage}\n";
  }
  return text + fmt::format("\\end{{{}}}\n", name);
}

std::string markdown_table(const PaperTable& table) {
  const std::size_t columns = table.alignment.size();
  std::vector<std::string> header(columns), rule(columns);
  for (const PaperRow& row : table.header) {
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      const std::string cell = markdown_cell(row.cells[k]);
      header[k] += (header[k].empty() || cell.empty() ? "" : " ") + cell;
    }
  }
  for (std::size_t k = 0; k < columns; ++k) rule[k] = table.alignment[k] == 'l' ? ":--" : "--:";
  std::string text = with_replacements(table.caption, kMarkdown) + "\n\n" + markdown_row(header, columns) +
                     markdown_row(rule, columns);
  for (const PaperRow& row : table.rows) {
    std::vector<std::string> cells;
    for (const PaperCell& cell : row.cells) cells.push_back(markdown_cell(cell));
    text += markdown_row(cells, columns);
  }
  if (!table.note.empty()) text += "\n*Note.* " + with_replacements(table.note, kMarkdown) + "\n";
  return text;
}

}  // namespace mbk
