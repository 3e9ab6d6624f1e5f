#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace mbk::recording {

/// A line of a text.
struct TextLine {
  std::size_t number = 0;  ///< from 1
  std::string_view text;   ///< without its line end
  bool terminated = true;
};

/// Walks through the lines of a text that is in memory, behind a byte order mark.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : text_(text) {
    if (text.starts_with("\xEF\xBB\xBF")) begin_ = 3;
  }

  std::optional<TextLine> next() {
    if (begin_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
    TextLine line{++number_, text_.substr(begin_, end - begin_), end < text_.size()};
    begin_ = end + 1;
    while (line.text.ends_with('\r')) line.text.remove_suffix(1);  // twice where a text was copied as text again
    return line;
  }
  /// Behind lines of blanks.
  std::optional<TextLine> next_filled() {
    for (auto line = next(); line; line = next()) {
      if (line->text.find_first_not_of(" \t") != line->text.npos) return line;
    }
    return std::nullopt;
  }
  /// Bytes from the next line on.
  [[nodiscard]] std::uint64_t left() const { return text_.size() - std::min(begin_, text_.size()); }

 private:
  std::string_view text_;
  std::size_t begin_ = 0, number_ = 0;
};

/// The cells between separators.
[[nodiscard]] inline std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t end = std::min(line.find(separator), line.size());
    cells.push_back(line.substr(0, end));
    if (end == line.size()) return cells;
    line.remove_prefix(end + 1);
  }
}

/// The words between blanks and tabs.
[[nodiscard]] inline std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> found;
  for (;;) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == line.npos) return found;
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    found.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

}  // namespace mbk::recording
