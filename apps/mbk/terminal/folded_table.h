#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace mbk::app {

/// A table that is split into parts below one another if it does not fit.
struct FoldedTable {
  std::size_t lines = 0;  ///< of the table; 0: there is none, or it cannot be split
  std::string text;       ///< replaces them; empty: they fit unchanged
};

/// The table that begins with the first of these lines, or the drawings side by side below a caption. Columns are
/// recognised by two blanks between them in all lines. Each part has the first column, and short columns without a
/// heading, such as units. A column that is wider than a part is broken between words.
/// @param columns  of the terminal
[[nodiscard]] FoldedTable folded_table(std::span<const std::string_view> lines, std::size_t columns);

}  // namespace mbk::app
