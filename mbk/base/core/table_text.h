#pragma once

#include <string>
#include <string_view>

namespace mbk {

/// Whether a spreadsheet would run the text as a formula: it begins with =, +, -, @ or a tab and is not a number.
[[nodiscard]] bool is_formula(std::string_view text);

/// A field of CSV: between quotes where it holds a separator, a quote or a line break (RFC 4180), and behind an
/// apostrophe where a spreadsheet would run it.
[[nodiscard]] std::string csv_field(std::string_view text);

/// Text as LaTeX prints it: what is a command there is escaped; the superscripts, the dot and the degree sign of units
/// become mathematics.
[[nodiscard]] std::string latex_text(std::string_view text);

}  // namespace mbk
