#pragma once

#include <string>

namespace mbk {

/// The text as UTF-8 of one line: control characters are replaced, and what is not UTF-8 is taken as Latin-1, which
/// recorders write.
[[nodiscard]] std::string printable(std::string text);

}  // namespace mbk
