#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/reproduction.h"

/// What the exhibits say, apart from what they compute. For the sources of this module only.
///
/// The words stand in text/*.md, a paragraph on each line:
///
///     ## erratum-4: (3.18), (3.21): antisymmetry may not be dropped         the exhibit's id and title
///     ### erratum-4: P1 with k_a = {k_a:.2f} N/m                            its tables' ids and captions, in their
///     order
///     #### Passivity index of P1's relaxed arm                           captions of its charts, notes below
///     ## how-rigs-are-made                                               a note that several exhibits have
///     [how-rigs-are-made]                                                its paragraphs stand here
///
/// A Markdown table below a table's caption gives columns of words: row by row, the rows found by their names. A
/// placeholder is a computed value, as {fmt} writes it.
namespace mbk::thesis {

/// Computed values by the names that a text has for them.
using TextValues = std::map<std::string, std::variant<int, double, std::string>, std::less<>>;

/// An exhibit while it is made, with the values that its text speaks of.
struct Draft : Exhibit {
  TextValues values;
};

struct TableText {
  std::string id, caption;
  std::vector<std::string> columns;            ///< of the Markdown table; the first is that of the rows' names
  std::vector<std::vector<std::string>> rows;  ///< of as many cells
};

struct ChartText {
  std::string caption;
  std::vector<std::string> notes;
};

struct ExhibitText {
  std::string id, title;
  std::vector<std::string> paragraphs;
  std::vector<TableText> tables;
  std::vector<ChartText> charts;
};

/// The files of text/ as they stood when the program was built.
[[nodiscard]] std::span<const std::string_view> text_files();

/// The exhibits of Markdown files, notes put in where they are asked for.
/// @fails  data: a line stands where nothing of its kind may; an id occurs twice; a note is missing or is nowhere used.
[[nodiscard]] Result<std::vector<ExhibitText>> read_text(std::span<const std::string_view> files);

/// Names of the placeholders of a text.
[[nodiscard]] std::set<std::string, std::less<>> placeholders(std::string_view text);

/// Names of all placeholders of an exhibit.
[[nodiscard]] std::set<std::string, std::less<>> placeholders(const ExhibitText& text);

/// Gives an exhibit its title, paragraphs, captions, notes and columns of words. A chart that has a title keeps it: it
/// is named by its data.
/// @param common  values that every text may speak of, and need not
/// @fails  data: a placeholder has no value or one that cannot be written so; a value of the draft is in no
/// placeholder;
///         tables, rows or charts of text and draft are not the same.
[[nodiscard]] Result<void> put_text(const ExhibitText& text, const TextValues& common, Draft& draft);

}  // namespace mbk::thesis
