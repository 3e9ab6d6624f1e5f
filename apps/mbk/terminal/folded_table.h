#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace mbk::app {

/// A table in parts below one another, where it does not fit.
struct FoldedTable {
  std::size_t lines = 0;  ///< of the table; 0: there is none, or it cannot come in parts
  std::string text;       ///< in place of them; empty: they fit as they are
};

/// The table that begins with the first of these lines, or the drawings beside one another below a caption. Columns are
/// told by the two blanks between them that all lines share. Each part has the first column; short columns without a
/// heading, such as units, stand in each part too. What is wider than a part by itself is broken between words.
/// @param columns  of the terminal
[[nodiscard]] FoldedTable folded_table(std::span<const std::string_view> lines, std::size_t columns);

}  // namespace mbk::app
