#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mbk::app {

/// Where people read: a stream of the process.
struct Terminal {
  bool there = false;         ///< otherwise it is a pipe or a file: nothing is broken or coloured
  bool colour = false;        ///< unless NO_COLOR is set or TERM is "dumb"
  std::size_t columns = 100;  ///< of its lines, from 60 to 100
};

/// Standard output or standard error, as it is now.   @param descriptor  system::kOutput or system::kError
[[nodiscard]] Terminal terminal_at(int descriptor);

/// Whether a line contains Braille dots or lines of axes (U+2500 to U+28FF without arrows and letters).
[[nodiscard]] bool is_drawing(std::string_view line);

/// Splits tables that are too wide (folded_table.h). Long lines are broken between words; the rest is indented like the
/// text of its line, and merges with an existing continuation. Lines of drawings are unchanged.
[[nodiscard]] std::string fitted(std::string_view text, std::size_t columns);

/// Colours headings, names of options, warnings and critical verdicts.
[[nodiscard]] std::string coloured(std::string_view text);

/// The text in the best form for this terminal; nothing in it can control the terminal (`printable_lines`).
[[nodiscard]] std::string for_people(const std::string& given, const Terminal& terminal);

}  // namespace mbk::app
