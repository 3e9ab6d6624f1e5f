#pragma once

#include <string>
#include <string_view>

namespace mbk {

/// The text as UTF-8 of one line: control characters are replaced, and what is not UTF-8 is taken as Latin-1, which
/// recorders write.
[[nodiscard]] std::string printable(std::string text);

/// Text of many lines as UTF-8 that a terminal shows and does not obey: of the control characters only line feeds and
/// tabs are left, and each byte that is not UTF-8 is taken as Latin-1.
[[nodiscard]] std::string printable_lines(std::string_view text);

}  // namespace mbk
