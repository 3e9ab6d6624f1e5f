#pragma once

#include <string>
#include <string_view>

namespace mbk {

/// A field of CSV: between quotes where it holds a comma, a quote or a line break (RFC 4180).
[[nodiscard]] std::string csv_field(std::string_view text);

/// Text as LaTeX prints it: what is a command there is escaped; the superscripts, the dot and the degree sign of units
/// become mathematics.
[[nodiscard]] std::string latex_text(std::string_view text);

}  // namespace mbk
