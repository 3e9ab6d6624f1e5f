#pragma once

#include <string>
#include <string_view>

namespace mbk {

/// Whether a spreadsheet would run the text as a formula: it begins with =, +, -, @ or a tab and is not a number.
[[nodiscard]] bool is_formula(std::string_view text);

/// A field of CSV: in quotes if it contains a separator, a quote or a line break (RFC 4180), and after an apostrophe if
/// a spreadsheet would run it.
[[nodiscard]] std::string csv_field(std::string_view text);

/// Text for LaTeX: commands are escaped; superscripts, dot and degree sign of units become mathematics.
[[nodiscard]] std::string latex_text(std::string_view text);

}  // namespace mbk
