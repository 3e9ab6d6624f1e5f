#include "mbk/files/recording/csv.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string_view>

#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/disk_pages.h"
#include "mbk/files/recording/encode.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxColumns = 10'000;

struct Line {
  std::size_t number = 0;  ///< from 1
  std::string_view text;   ///< without its line end
  bool terminated = true;
};

/// The text, all of it or as far as it was read.
class CsvText {
 public:
  explicit CsvText(std::string_view all) : so_far_(all), size_(all.size()) {}
  explicit CsvText(FileInPassing& file) : file_(&file), so_far_(file.text()), size_(file.size()) {}

  [[nodiscard]] std::string_view so_far() const { return so_far_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool is_complete() const { return so_far_.size() == size_; }
  /// Whether there is more than before.
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
  FileInPassing* file_ = nullptr;
  std::string_view so_far_;
  std::size_t size_;
  Result<void> status_;
};

/// Walks through the lines. Those before the last two need not stay in memory.
class Lines {
 public:
  explicit Lines(CsvText& text) : text_(text) {
    if (text.so_far().starts_with("\xEF\xBB\xBF")) begin_ = 3;
  }

  /// The next that is neither empty nor a comment.
  std::optional<Line> next() {
    while (auto line = next_of_all()) {
      const auto first = line->text.find_first_not_of(" \t");
      if (first != line->text.npos && line->text[first] != '#' && line->text[first] != '%') return line;
    }
    return std::nullopt;
  }

  std::optional<Line> next_of_all() {
    std::size_t end = text_.so_far().find('\n', begin_);
    for (std::size_t seen = text_.so_far().size(); end == std::string_view::npos && text_.read_on();
         seen = text_.so_far().size()) {
      end = text_.so_far().find('\n', seen);
    }
    const std::string_view text = text_.so_far();
    end = std::min(end, text.size());
    if (begin_ == text.size() || !text_.status()) return std::nullopt;
    Line line{++number_, text.substr(begin_, end - begin_), end < text.size()};
    begin_ = std::min(end + 1, text.size());
    if (line.text.ends_with('\r')) line.text.remove_suffix(1);
    return line;
  }

 private:
  CsvText& text_;
  std::size_t begin_ = 0, number_ = 0;
};

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) cell.remove_suffix(1);
  if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
  return cell;
}

/// Digits with at most a sign and a point, so few that one division gives their value to rounding (Clinger 1990): what
/// most loggers write. Nothing where a cell holds anything else.
std::optional<double> plain_number(std::string_view cell) {
  constexpr std::uint64_t kExact = std::uint64_t{1} << 53;
  constexpr std::size_t kLongest = 17;  // a point and 16 digits
  constexpr std::array kPowers = {1e0, 1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7, 1e8,
                                  1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16};
  const bool negative = cell.starts_with('-');
  if (negative) cell.remove_prefix(1);
  if (cell.size() > kLongest) return std::nullopt;
  std::uint64_t digits = 0;
  std::size_t point = cell.size();
  for (std::size_t k = 0; k < cell.size(); ++k) {
    const auto digit = static_cast<unsigned>(cell[k] - '0');
    if (digit <= 9) {
      digits = 10 * digits + digit;
    } else if (cell[k] == '.' && point == cell.size()) {
      point = k;
    } else {
      return std::nullopt;
    }
  }
  const std::size_t decimals = point == cell.size() ? 0 : cell.size() - point - 1;
  const bool any = decimals > 0 || point > 0;
  if (!any || digits > kExact || decimals >= kPowers.size()) return std::nullopt;
  const double value = static_cast<double>(digits) / kPowers[decimals];
  return negative ? -value : value;
}

/// The number in a cell; NaN where it is empty; nothing where it is not a number.
std::optional<double> number(std::string_view cell) {
  if (const auto plain = plain_number(cell)) return plain;
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

char separator_of(CsvText& text) {
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
void take_comments(CsvText& text, Contents& contents) {
  constexpr std::string_view kMark = "# ", kEvent = "event ";
  if (!text.so_far().starts_with(fmt::format("{}{}", kMark, kLayout))) return;
  Lines lines(text);
  lines.next_of_all();
  while (const auto whole = lines.next_of_all()) {
    if (!whole->text.starts_with(kMark)) return;
    const std::string_view line = whole->text.substr(kMark.size());
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

  Result<void> read(CsvText& text) {
    contents.format = "CSV";
    contents.table = true;
    take_comments(text, contents);
    separator_ = separator_of(text);
    Lines lines(text);
    std::optional<Line> line = lines.next();
    if (line && is_header(line->text)) {
      for (const std::string_view cell : cells_of(line->text, separator_)) header_.emplace_back(cell);
      header_line_ = line->number;
      line = lines.next();
    }
    if (!text.status()) return text.status();
    if (!line) return bad_data("the file holds no line of numbers", "nothing was recorded, or it is not a table");
    if (auto ok = find_columns(*line); !ok) return ok;
    make_room(text);

    for (; line; line = next_) {
      text.forget(static_cast<std::size_t>(line->text.data() - text.so_far().data()));
      next_ = lines.next();
      if (!text.status()) return text.status();
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
    if (rows_ == numbers_.front().size()) make_rows(rows_ + rows_ / 4 + 1);
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
      numbers_[count - 1][rows_] = value.value_or(0.0);
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
    if (rows_ >= on_disk_from_) put_on_disk();
    return {};
  }

  /// The rows so far of a long table, again and again.
  void put_on_disk() {
    constexpr Index kAtOnce = 1 << 17;
    on_disk_from_ = rows_ + kAtOnce;
    if (numbers_.front().size() <= kLong) return;
    for (std::size_t c = 0; c < columns_; ++c) {
      on_disk_[c] += disk_.take(numbers_[c].data() + on_disk_[c], rows_ - on_disk_[c]);
    }
  }

  void finish() {
    if (separator_ != ',') {
      contents.notes.insert(contents.notes.begin(),
                            fmt::format("columns are separated by {}", separator_ == ';' ? "semicolons" : "tabs"));
    }
    if (trailing_) contents.notes.emplace_back("every line ends with a separator, which was not taken as a column");
    for (std::size_t c = 0; c < columns_; ++c) {
      if (!header_.empty()) contents.arrays[c].name = printable(header_[c]);
      numbers_[c].conservativeResize(rows_);
      contents.arrays[c].values = SharedMatrix::of_column(std::move(numbers_[c]));
    }
  }

  /// Columns long enough for every line that can come: one for each line end, and no line is shorter than its cells. Of
  /// a text that is not all there, as many as its first part lets one expect.
  void make_room(const CsvText& text) {
    const std::string_view there = text.so_far();
    const auto ends = static_cast<std::size_t>(std::ranges::count(there, '\n'));
    const double parts = 1.02 * static_cast<double>(text.size()) / static_cast<double>(there.size());
    const auto expected = text.is_complete() ? ends : static_cast<std::size_t>(static_cast<double>(ends) * parts);
    contents.arrays.resize(columns_);
    numbers_.resize(columns_);
    make_rows(static_cast<Index>(std::min(expected, text.size() / columns_) + 1));
  }

  void make_rows(Index rows) {
    for (Vector& column : numbers_) column.conservativeResize(rows);
    on_disk_.assign(columns_, 0);  // the longer ones stand elsewhere
  }

  char separator_ = ',';
  std::vector<std::string> header_;
  std::size_t header_line_ = 0;
  std::size_t columns_ = 0;
  std::vector<Vector> numbers_;  ///< column by column, with room for more rows
  std::vector<Index> on_disk_;   ///< of each column, the numbers at its begin whose memory is a file's
  Index on_disk_from_ = 0;       ///< rows at which it is time for more
  DiskPages disk_;
  bool trailing_ = false;  ///< every line ends with a separator
  Index rows_ = 0;         ///< complete ones so far
  std::size_t last_line_ = 0;
  std::optional<Line> next_;
};

Result<Contents> decode_text(CsvText text) {
  Table table;
  if (auto ok = table.read(text); !ok) return tl::unexpected(ok.error());
  return std::move(table.contents);
}

}  // namespace

Result<Contents> decode_csv(std::span<const std::byte> file) {
  return decode_text(CsvText({reinterpret_cast<const char*>(file.data()), file.size()}));
}

Result<Contents> decode_csv(FileInPassing& file) {
  return decode_text(CsvText(file));
}

}  // namespace mbk::recording
