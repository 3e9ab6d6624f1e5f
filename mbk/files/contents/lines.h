#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/printable.h"

namespace mbk::recording {

/// The lines of a text, each in UTF-8 without control characters; at least one. Line breaks of any kind part them, and
/// those at the end are left out.
[[nodiscard]] inline std::vector<std::string> printable_lines(const std::string& text) {
  std::vector<std::string> lines(1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
    if (text[i] == '\n' || text[i] == '\r') {
      lines.emplace_back();
    } else {
      lines.back() += text[i];
    }
  }
  while (lines.size() > 1 && lines.back().empty()) lines.pop_back();
  for (std::string& line : lines) line = printable(std::move(line));
  return lines;
}

/// The same lines as one, with "; " between them.
[[nodiscard]] inline std::string in_one_line(const std::string& text) {
  std::string joined;
  for (const std::string& line : printable_lines(text)) {
    if (!joined.empty()) joined += "; ";
    joined += line;
  }
  return joined;
}

}  // namespace mbk::recording
