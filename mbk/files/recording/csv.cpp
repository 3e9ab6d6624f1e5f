#include "mbk/files/recording/csv.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string_view>

#include "mbk/files/recording/byte_view.h"
#include "mbk/files/recording/encode.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxColumns = 10'000;

struct Line {
  std::size_t number = 0;  ///< from 1
  std::string_view text;   ///< without its line end
  bool terminated = true;
};

/// Walks through the lines that are neither empty nor comments.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }

  std::optional<Line> next() {
    while (!rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      Line line{++number_, rest_.substr(0, end), end < rest_.size()};
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      if (line.text.ends_with('\r')) line.text.remove_suffix(1);
      const auto first = line.text.find_first_not_of(" \t");
      if (first == line.text.npos || line.text[first] == '#' || line.text[first] == '%') continue;
      return line;
    }
    return std::nullopt;
  }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) cell.remove_suffix(1);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
  return cell;
}

/// The number in a cell; NaN where it is empty; nothing where it is not a number.
std::optional<double> number(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.empty()) return std::numeric_limits<double>::quiet_NaN();
  if (cell.front() == '+') {
    cell.remove_prefix(1);
    if (cell.empty() || cell.front() == '-' || cell.front() == '+') return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (end != cell.data() + cell.size()) return std::nullopt;
  if (error == std::errc()) return value;
  if (error != std::errc::result_out_of_range) return std::nullopt;
  value = std::strtod(std::string(cell).c_str(), nullptr);  // too small is 0 or subnormal; too large is not a number
  if (std::isinf(value)) return std::nullopt;
  return value;
}

/// Calls use(cell) for each cell until it returns false.
template <class Use>
void for_each_cell(std::string_view line, char separator, Use use) {
  for (;;) {
    const std::size_t end = std::min(line.find(separator), line.size());
    if (!use(line.substr(0, end)) || end == line.size()) return;
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for_each_cell(line, separator, [&](std::string_view cell) {
    cells.push_back(trimmed(cell));
    return true;
  });
  return cells;
}

char separator_of(std::string_view text) {
  Lines lines(text);
  char found = ',';
  for (int i = 0; i < 3; ++i) {
    const auto line = lines.next();
    if (!line) break;
    if (line->text.find(';') != line->text.npos) return ';';
    if (line->text.find('\t') != line->text.npos) found = '\t';
  }
  return found;
}

std::string place(std::size_t line) {
  return fmt::format("line {}", line);
}

tl::unexpected<Error> not_a_number(const Line& line, std::size_t column, std::string_view cell, char separator) {
  cell = trimmed(cell);
  const std::string where = fmt::format("line {}, column {}", line.number, column);
  if (separator != ',' && cell.find(',') != cell.npos) {
    return bad_data(fmt::format("'{}' has a decimal comma", printable(std::string(cell.substr(0, 40)))),
                    "write the file with decimal points", where);
  }
  return bad_data(fmt::format("'{}' is not a number", printable(std::string(cell.substr(0, 40)))),
                  "the table must hold numbers, separated by commas, semicolons or tabs", where);
}

/// "0.05 3 onset": time, value and name of an event.
std::optional<Event> event(std::string_view text) {
  const auto first = text.find(' ');
  const auto second = first == text.npos ? text.npos : text.find(' ', first + 1);
  if (first == text.npos) return std::nullopt;
  const auto time = number(text.substr(0, first));
  const auto value = number(text.substr(first + 1, second - first - 1));
  if (!time || !value) return std::nullopt;
  return Event{*time, std::string(second == text.npos ? "" : text.substr(second + 1)), *value};
}

/// What our own writer says in the comments before the header (encode.h); of other files they are only comments.
void take_comments(std::string_view text, Contents& contents) {
  constexpr std::string_view kMark = "# ", kEvent = "event ";
  if (!text.starts_with(fmt::format("{}{}", kMark, kLayout))) return;
  for (std::size_t end = text.find('\n'); end != text.npos; end = text.find('\n')) {
    text.remove_prefix(end + 1);
    if (!text.starts_with(kMark)) return;
    std::string_view line = text.substr(kMark.size(), std::min(text.find('\n'), text.size()) - kMark.size());
    if (line.ends_with('\r')) line.remove_suffix(1);
    const auto colon = line.find(": ");
    if (line.starts_with(kEvent)) {
      if (const auto one = event(line.substr(kEvent.size()))) contents.events.push_back(*one);
    } else if (colon != line.npos) {
      contents.metadata[printable(std::string(line.substr(0, colon)))] = printable(std::string(line.substr(colon + 2)));
    }
  }
}

class Table {
 public:
  Contents contents;

  Result<void> read(std::string_view text) {
    contents.format = "CSV";
    contents.table = true;
    take_comments(text, contents);
    separator_ = separator_of(text);
    Lines lines(text);
    std::optional<Line> line = lines.next();
    if (line && is_header(line->text)) {
      header_ = cells_of(line->text, separator_);
      header_line_ = line->number;
      line = lines.next();
    }
    if (!line) return bad_data("the file holds no line of numbers", "nothing was recorded, or it is not a table");
    if (auto ok = find_columns(*line); !ok) return ok;
    make_room(text);

    for (; line; line = next_) {
      next_ = lines.next();
      if (auto ok = add(*line, !next_); !ok) return ok;
    }
    if (rows_ == 0) {
      return bad_data(fmt::format("the only line of numbers, line {}, is incomplete", last_line_),
                      "nothing complete was recorded");
    }
    finish();
    return {};
  }

 private:
  [[nodiscard]] bool is_header(std::string_view line) const {
    bool header = false;
    for_each_cell(line, separator_, [&](std::string_view cell) {
      const bool decimal_comma = separator_ != ',' && cell.find_first_not_of("+-0123456789.,eE \t") == cell.npos;
      header = header || (!number(cell) && !decimal_comma);
      return true;
    });
    return header;
  }

  Result<void> find_columns(const Line& first) {
    const auto cells = cells_of(first.text, separator_);
    columns_ = cells.size();
    const bool ends_empty =
        columns_ > 1 && cells.back().empty() && (first.terminated || header_.size() + 1 == columns_);
    trailing_ = ends_empty && (header_.empty() || header_.size() + 1 == columns_ || header_.back().empty());
    if (trailing_) --columns_;
    if (header_.size() == columns_ + 1 && header_.back().empty()) header_.pop_back();
    if (columns_ > kMaxColumns) {
      return bad_data(fmt::format("{} columns are more than {}", columns_, kMaxColumns), "every sample is one line",
                      place(first.number));
    }
    if (header_.empty() || header_.size() == columns_) return {};
    if (!first.terminated && columns_ < header_.size()) {
      columns_ = header_.size();  // the one line there is was not written completely
      return {};
    }
    return bad_data(fmt::format("the header names {} columns, line {} has {}", header_.size(), first.number, columns_),
                    "give every column one name", place(header_line_));
  }

  Result<void> add(const Line& line, bool last) {
    last_line_ = line.number;
    std::size_t count = 0;
    std::string_view wrong;
    std::size_t wrong_column = 0;
    bool last_is_empty = false;
    for_each_cell(line.text, separator_, [&](std::string_view cell) {
      ++count;
      last_is_empty = trimmed(cell).empty();
      if (count > columns_) return count <= columns_ + 64;
      const auto value = number(cell);
      if (!value && wrong.data() == nullptr) wrong = cell, wrong_column = count;
      contents.arrays[count - 1].values(rows_, 0) = value.value_or(0.0);
      return true;
    });
    const bool trailing = trailing_ && count == columns_ + 1 && last_is_empty;
    const bool complete = count == columns_ || trailing;
    if (last && (count < columns_ || (!line.terminated && count == columns_ && last_is_empty) ||
                 (!line.terminated && wrong.data() != nullptr && wrong_column == count))) {
      contents.notes.push_back(
          fmt::format("line {} is incomplete (the recording was cut off there) and was ignored", line.number));
      return {};
    }
    if (!complete || (trailing_ && !trailing && !last)) {
      return bad_data(fmt::format("{} cells where the lines before have {}", count, columns_ + (trailing_ ? 1 : 0)),
                      "every line must have a cell for every column", place(line.number));
    }
    if (wrong.data() != nullptr) return not_a_number(line, wrong_column, wrong, separator_);
    if (!line.terminated && !trailing) {
      contents.notes.push_back(fmt::format(
          "line {} has no line end: if the recording was cut off there, its last number may be cut too", line.number));
    }
    ++rows_;
    return {};
  }

  void finish() {
    if (separator_ != ',') {
      contents.notes.insert(contents.notes.begin(),
                            fmt::format("columns are separated by {}", separator_ == ';' ? "semicolons" : "tabs"));
    }
    if (trailing_) contents.notes.emplace_back("every line ends with a separator, which was not taken as a column");
    for (std::size_t c = 0; c < columns_; ++c) {
      if (!header_.empty()) contents.arrays[c].name = printable(std::string(header_[c]));
      contents.arrays[c].values.conservativeResize(rows_, 1);
    }
  }

  /// Columns long enough for every line that can come: one for each line end, and no line is shorter than its cells.
  void make_room(std::string_view text) {
    const auto ends = static_cast<std::size_t>(std::ranges::count(text, '\n'));
    const auto rows = static_cast<Index>(std::min(ends, text.size() / columns_) + 1);
    contents.arrays.resize(columns_);
    for (Array& array : contents.arrays) array.values.resize(rows, 1);
  }

  char separator_ = ',';
  std::vector<std::string_view> header_;
  std::size_t header_line_ = 0;
  std::size_t columns_ = 0;
  bool trailing_ = false;  ///< every line ends with a separator
  Index rows_ = 0;         ///< complete ones so far
  std::size_t last_line_ = 0;
  std::optional<Line> next_;
};

}  // namespace

Result<Contents> decode_csv(std::span<const std::byte> file) {
  Table table;
  if (auto ok = table.read({reinterpret_cast<const char*>(file.data()), file.size()}); !ok) {
    return tl::unexpected(ok.error());
  }
  return std::move(table.contents);
}

}  // namespace mbk::recording
