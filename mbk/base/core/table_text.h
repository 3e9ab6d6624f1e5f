#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mbk {

/// Whether a spreadsheet would run the text as a formula: it begins with =, +, -, @ or a tab and is not a number.
[[nodiscard]] bool is_formula(std::string_view text);

/// A field of CSV: in quotes if it contains a separator, a quote or a line break (RFC 4180), and after an apostrophe if
/// a spreadsheet would run it.
[[nodiscard]] std::string csv_field(std::string_view text);

/// Text for LaTeX: commands are escaped; superscripts, dot and degree sign of units become mathematics.
[[nodiscard]] std::string latex_text(std::string_view text);

/// A cell of a table for a paper.
struct PaperCell {
  enum class Kind {
    text,    ///< escaped
    number,  ///< digits, "-", "±" and brackets, as in "-1.20 ± 0.03"
    symbol,  ///< mathematics in LaTeX's notation without $, as in "K_{xx}"
  };
  std::string text;
  Kind kind = Kind::text;
};

struct PaperRow {
  std::vector<PaperCell> cells;  ///< if fewer than the columns, the last one spans the rest, left-aligned
  bool rule_above = false;       ///< in LaTeX
};

/// A table for a paper. Caption and note are plain text.
struct PaperTable {
  std::string caption, note;  ///< the note may be empty
  std::string alignment;      ///< "l" or "r" for each column
  std::vector<PaperRow> header, rows;
  bool sideways = false;  ///< in LaTeX on a page of its own, turned by 90°
};

[[nodiscard]] std::string latex_cell(const PaperCell& cell);

/// For LaTeX, with booktabs; made narrower than the text if it is wider.
[[nodiscard]] std::string latex_table(const PaperTable& table);

/// For Markdown with tables and mathematics, as pandoc and GitHub read it.
[[nodiscard]] std::string markdown_table(const PaperTable& table);

}  // namespace mbk
