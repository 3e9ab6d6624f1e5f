#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// A line of a text.
struct CsvLine {
  std::size_t number = 0;  ///< from 1
  std::string_view text;   ///< without its line end
  bool terminated = true;
};

/// The text, all of it or as far as it was read.
class CsvText {
 public:
  explicit CsvText(std::string_view all) : so_far_(all), size_(all.size()), line_end_(line_end_of(all)) {}
  explicit CsvText(FileInPassing& file)
      : file_(&file), so_far_(file.text()), size_(file.size()), line_end_(line_end_of(file.text())) {}

  [[nodiscard]] std::string_view so_far() const { return so_far_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool is_complete() const { return so_far_.size() == size_; }
  /// The last character of a line end: a line feed, or in a text without any a carriage return.
  [[nodiscard]] char line_end() const { return line_end_; }
  /// Whether more text was read.
  bool read_on() {
    if (is_complete() || !status_) return false;
    status_ = file_->read_on();
    so_far_ = file_->text();
    return status_.has_value();
  }
  void forget(std::size_t before) {
    if (file_ != nullptr) file_->forget(before);
  }
  [[nodiscard]] const Result<void>& status() const { return status_; }

 private:
  static char line_end_of(std::string_view text) {
    return text.find('\n') == text.npos && text.find('\r') != text.npos ? '\r' : '\n';
  }

  FileInPassing* file_ = nullptr;
  std::string_view so_far_;
  std::size_t size_;
  char line_end_;
  Result<void> status_;
};

[[nodiscard]] inline bool is_comment(std::string_view line) {
  const auto first = line.find_first_not_of(" \t");
  return first != line.npos && (line[first] == '#' || line[first] == '%');
}

/// Iterates over the lines. Those before the last two need not stay in memory.
class CsvLines {
 public:
  explicit CsvLines(CsvText& text) : text_(text) {
    if (text.so_far().starts_with("\xEF\xBB\xBF")) begin_ = 3;
  }

  /// The next line that is neither empty nor a comment.
  std::optional<CsvLine> next() {
    return next([](const CsvLine&) {});
  }
  /// @param passed_over  is called for each comment before it
  template <class Use>
  std::optional<CsvLine> next(Use passed_over) {
    while (auto line = next_of_all()) {
      if (!line->text.empty() && line->text.front() > '%') return line;  // as digits and signs are
      const auto first = line->text.find_first_not_of(" \t");
      if (first == line->text.npos) continue;
      if (line->text[first] != '#' && line->text[first] != '%') return line;
      passed_over(*line);
    }
    return std::nullopt;
  }

  std::optional<CsvLine> next_of_all() {
    std::size_t end = text_.so_far().find(text_.line_end(), begin_);
    for (std::size_t seen = text_.so_far().size(); end == std::string_view::npos && text_.read_on();
         seen = text_.so_far().size()) {
      end = text_.so_far().find(text_.line_end(), seen);
    }
    const std::string_view text = text_.so_far();
    end = std::min(end, text.size());
    if (begin_ == text.size() || !text_.status()) return std::nullopt;
    CsvLine line{++number_, text.substr(begin_, end - begin_), end < text.size()};
    begin_ = std::min(end + 1, text.size());
    while (line.text.ends_with('\r')) line.text.remove_suffix(1);  // twice where a text was copied as text again
    return line;
  }

  /// @param number  of the line that begins there
  void go_on_at(std::size_t number, const char* begin) {
    number_ = number - 1;
    begin_ = static_cast<std::size_t>(begin - text_.so_far().data());
  }

 private:
  CsvText& text_;
  std::size_t begin_ = 0, number_ = 0;
};

inline constexpr std::size_t kMaxCsvColumns = 10'000, kMaxCells = kMaxCsvColumns + 2;  ///< cells that are looked at
inline constexpr char kBlanks = ' ';  ///< separator of cells that are separated by any blanks and tabs

/// Calls use(cell) for each cell until it returns false. Quotes have no meaning.
template <class Use>
void for_each_cell(std::string_view line, char separator, Use use) {
  if (separator == kBlanks) {
    for (;;) {
      const std::size_t begin = line.find_first_not_of(" \t");
      if (begin == line.npos) return;
      const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
      if (!use(line.substr(begin, end - begin)) || end == line.size()) return;
      line.remove_prefix(end);
    }
  }
  for (;;) {
    const std::size_t end = std::min(line.find(separator), line.size());
    if (!use(line.substr(0, end)) || end == line.size()) return;
    line.remove_prefix(end + 1);
  }
}

/// The cells of a line, each with its quotes; a separator in quotes is part of its cell.
/// @param most  cells that are given at most
[[nodiscard]] std::vector<std::string_view> quoted_cells(std::string_view line, char separator, std::size_t most);

/// The lines before the rows of a table.
struct CsvHead {
  char separator = ',';
  std::size_t first_row = 0;       ///< line number; 0 if no line contains numbers
  std::vector<std::string> names;  ///< of the columns, as written; empty without a header
  std::size_t header_line = 0;     ///< its number
  std::vector<std::string> units;  ///< of the columns, if a line gives them
  std::vector<CsvLine> above;      ///< lines of text and comments above all of this
  std::vector<std::string> notes;
};

/// Finds the table in a text: its separator, its names, its units, its first row.
/// @fails  data: two readings are possible, or lines above the table may be part of it; the text cannot be read.
[[nodiscard]] Result<CsvHead> find_table(CsvText& text);

}  // namespace mbk::recording
