#pragma once

#include <string>
#include <string_view>

namespace mbk {

/// The text as one line of UTF-8: control characters are replaced, and bytes that are not UTF-8 are read as Latin-1,
/// which some recorders write.
[[nodiscard]] std::string printable(std::string text);

/// Text of several lines as UTF-8 that cannot control a terminal: all control characters except line feeds and tabs are
/// removed, and each byte that is not UTF-8 is read as Latin-1.
[[nodiscard]] std::string printable_lines(std::string_view text);

}  // namespace mbk
