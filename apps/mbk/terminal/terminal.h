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

/// Standard output or standard error, as it is now.   @param descriptor  STDOUT_FILENO or STDERR_FILENO
[[nodiscard]] Terminal terminal_at(int descriptor);

/// Whether a line holds Braille dots or lines of axes (U+2500 to U+28FF without arrows and letters).
[[nodiscard]] bool is_drawing(std::string_view line);

/// Tables that are too wide come in parts (folded_table.h). Lines that are too long are broken between words; what goes
/// on stands under the text of its line, and flows into the line that goes on there already. Lines of drawings stay as
/// they are.
[[nodiscard]] std::string fitted(std::string_view text, std::size_t columns);

/// With headings, names of options, warnings and verdicts that nobody may miss in colour.
[[nodiscard]] std::string coloured(std::string_view text);

/// The text as this terminal shows it best; nothing in it can drive one (`printable_lines`).
[[nodiscard]] std::string for_people(const std::string& given, const Terminal& terminal);

}  // namespace mbk::app
