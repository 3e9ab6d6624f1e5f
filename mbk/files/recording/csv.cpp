#include "mbk/files/recording/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/utf16.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/csv_text.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/preamble.h"
#include "mbk/files/recording/si_units.h"
#include "mbk/files/recording/table_columns.h"

namespace mbk::recording {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string place(std::size_t line) {
  return fmt::format("line {}", line);
}

/// A cell that is not a number, for messages.
Error not_a_number(std::size_t line, std::size_t column, std::string_view cell, bool decimal_commas) {
  cell = without_quotes(cell);
  const auto count = [cell](char c) { return std::ranges::count(cell, c); };
  std::string remedy = "write numbers only, separated by commas, semicolons, tabs or blanks";
  constexpr auto kMissing = std::to_array<std::string_view>(
      {"NA", "N/A", "n/a", "-", "null", "NULL", "None", "#N/A", "#DIV/0!", "#NUM!", "#VALUE!", "#REF!", "#NAME?"});
  const std::size_t blank = cell.rfind(' ');
  if (std::ranges::find(kMissing, cell) != kMissing.end()) {
    remedy = "leave the cell empty or write nan for a missing value";
  } else if (!cell.empty() && cell.front() >= '0' && cell.front() <= '9' &&
             (count(':') >= 1 || count('/') == 2 || (count('.') == 2 && count(':') > 0))) {
    remedy = "write times as 10:15:30.123 or 2024-03-01T10:15:30.123, or as seconds";
  } else if (blank != cell.npos && cell_number(cell.substr(0, blank)) && find_unit(cell.substr(blank + 1)) != nullptr) {
    remedy = "write only numbers, and put the unit in the column name";
  } else if (cell.starts_with('[') || cell.starts_with('(')) {
    remedy = "if the cell contains several numbers, write each in its own column";
  } else if (decimal_commas && cell.find('.') != cell.npos) {
    remedy = "the file has decimal commas: export it with decimal points throughout";
  }
  return bad_data(fmt::format("'{}' is not a number", printable(std::string(cell.substr(0, 40)))), std::move(remedy),
                  fmt::format("line {}, column {}", line, column))
      .value();
}

/// "0.05 3 onset": time, value and name of an event.
std::optional<Event> event(std::string_view text) {
  const auto first = text.find(' ');
  const auto second = first == text.npos ? text.npos : text.find(' ', first + 1);
  if (first == text.npos) return std::nullopt;
  const auto time = cell_number(text.substr(0, first));
  const auto value = cell_number(text.substr(first + 1, second - first - 1));
  if (!time || !value) return std::nullopt;
  return Event{*time, std::string(second == text.npos ? "" : text.substr(second + 1)), *value};
}

/// Metadata that mbk writes in comments before the header (encode.h); in other files they are only comments.
void take_comments(CsvText& text, Contents& contents) {
  constexpr std::string_view kMark = "# ", kEvent = "event ";
  if (!text.so_far().starts_with(fmt::format("{}{}", kMark, kLayout))) return;
  CsvLines lines(text);
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

/// Non-numeric contents of a column.
struct CsvColumn {
  std::optional<Error> obstacle;  ///< its first cell that is not a number
  Index instants = 0;             ///< cells that are times of day or dates
  bool dates = false;
  std::int64_t first_day = 0;
  double latest = 0.0;  ///< [s] the last time of day
  int midnights = 0;
  bool mixed = false;  ///< times with and without a date
  Rests rests;         ///< of whole numbers
};

class Table {
 public:
  Contents contents;

  Result<void> read(CsvText& text) {
    contents.format = "CSV";
    contents.table = true;
    line_end_ = text.line_end();
    take_comments(text, contents);
    head_ = MBK_TRY(find_table(text));
    take_preamble();
    CsvLines lines(text);
    std::optional<CsvLine> line = lines.next();
    if (head_.first_row == 0) return no_numbers(text, lines, line);
    while (line && line->number < head_.first_row) line = lines.next();
    if (!text.status()) return text.status();
    MBK_TRY(find_columns(*line));
    make_room(text);

    const auto among_rows = [this](const CsvLine& comment) {
      constexpr std::size_t kMax = 12;
      if (unread_.size() >= kMax) return;
      if (auto note = unread_statement(comment)) unread_.push_back(std::move(*note));
    };
    while (line) {
      text.forget(static_cast<std::size_t>(line->text.data() - text.so_far().data()));
      const char* const end = text.so_far().data() + text.so_far().size();
      if (const Rows plain = take_plain_rows(line->text.data(), end); plain.count > 0) {
        lines.go_on_at(line->number + plain.count, plain.end);
        line = lines.next(among_rows);
        continue;
      }
      const auto next = lines.next(among_rows);
      if (!text.status()) return text.status();
      MBK_TRY(add(*line, !next, text.so_far().data() + text.so_far().size()));
      line = next;
    }
    if (!text.status()) return text.status();
    if (rows_.rows() == 0) {
      return bad_data(fmt::format("the only data line, line {}, is incomplete", last_line_),
                      "check whether the recording was cut off");
    }
    return finish();
  }

 private:
  /// Statements about all columns in the lines above the table.
  void take_preamble() {
    Preamble said = read_preamble(head_.above);
    head_.above.clear();
    contents.rate_hz = said.rate_hz.value_or(0.0);
    contents.rate_from = std::move(said.rate_from);
    for (const Unit* unit : said.units) contents.units.emplace_back(unit->name);
    head_.notes.insert(head_.notes.end(), std::make_move_iterator(said.notes.begin()),
                       std::make_move_iterator(said.notes.end()));
  }

  /// Why this text is not a table: its second or only line contains no number.
  static Result<void> no_numbers(const CsvText& text, CsvLines& lines, std::optional<CsvLine> line) {
    const auto second = line ? lines.next() : std::nullopt;
    if (!text.status()) return text.status();
    if (!second) return bad_data("the file contains no line of numbers", "nothing was recorded, or it is not a table");
    constexpr std::size_t kShown = 40;
    return with_code(
        kNoTable, bad_data(fmt::format("the file is text without a table of numbers ({}: '{}' is not a number)",
                                       place(second->number), printable(std::string(second->text.substr(0, kShown)))),
                           "write one line per sample, with numbers separated by commas, semicolons, tabs or blanks"));
  }

  Result<void> find_columns(const CsvLine& first) {
    std::vector<std::string>& names = head_.names;
    const auto cells = quoted_cells(first.text, head_.separator, kMaxCells);
    columns_ = cells.size();
    const bool ends_empty =
        columns_ > 1 && without_quotes(cells.back()).empty() && (first.terminated || names.size() + 1 == columns_);
    trailing_ = ends_empty && (names.empty() || names.size() + 1 == columns_ || names.back().empty());
    if (trailing_) --columns_;
    if (names.size() == columns_ + 1 && names.back().empty()) names.pop_back();
    if (columns_ > kMaxCsvColumns) {
      return bad_data(fmt::format("the table has more than {} columns", kMaxCsvColumns), "write one line per sample",
                      place(first.number));
    }
    kinds_.resize(columns_);
    if (names.empty() || names.size() == columns_) return {};
    if (!first.terminated && columns_ < names.size()) {
      columns_ = names.size();  // the one line there is was not written completely
      kinds_.resize(columns_);
      return {};
    }
    const bool both = head_.separator == ',' && columns_ == 2 * names.size();
    return bad_data(
        fmt::format("the header names {} columns, but line {} has {}", names.size(), first.number, columns_),
        both ? "if commas are also decimal points, export with semicolons between the columns"
             : "give every column exactly one name",
        place(head_.header_line));
  }

  /// @param end  of the text that is there
  Result<void> add(const CsvLine& line, bool last, const char* end) {
    last_line_ = line.number;
    Row row = decimal_commas_ ? Row{0, true, false} : take_plain(line.text, end);
    if (row.odd || (row.count != columns_ && line.text.find('"') != line.text.npos)) row = part_odd(line.text);
    if (row.odd || row.count != columns_) row = without_comment(line, end, row);
    const bool trailing = trailing_ && row.count == columns_ + 1 && row.last_is_empty;
    const bool complete = row.count == columns_ || trailing;
    const bool last_is_cut =
        row.odd && row.count == columns_ && odd_.back().kind == Odd::words && !kinds_.back().obstacle;
    if (last &&
        (row.count < columns_ || (!line.terminated && row.count == columns_ && (row.last_is_empty || last_is_cut)))) {
      contents.notes.push_back(
          fmt::format("line {} is incomplete (the recording was cut off there) and was ignored", line.number));
      return {};
    }
    if (!complete || (trailing_ && !trailing && !last)) return wrong_count(line, row.count);
    if (row.odd) {
      MBK_TRY(refuse_header(line));
      MBK_TRY(take_odd(line));
    }
    if (!line.terminated && !trailing) {
      contents.notes.push_back(
          fmt::format("line {} has no line end: if the recording was cut off there, its last number may be truncated",
                      line.number));
    }
    rows_.next_row();
    return {};
  }

  /// The names of the columns in the middle of the table: a logger was started again.
  [[nodiscard]] Result<void> refuse_header(const CsvLine& line) const {
    const auto same = [](const Odd& one, const std::string& name) { return without_quotes(one.cell) == name; };
    if (head_.names.empty() || !std::ranges::equal(odd_, head_.names, same)) return {};
    return bad_data(
        fmt::format("the column names of line {} are repeated: another recording begins there", head_.header_line),
        "write each recording to its own file", place(line.number));
  }

  [[nodiscard]] Result<void> wrong_count(const CsvLine& line, std::size_t count) const {
    bool numbers = false;
    for_each_cell(line.text, head_.separator, [&](std::string_view cell) {
      numbers = cell_number(cell) && !without_quotes(cell).empty();
      return !numbers;
    });
    if (!numbers) {
      return bad_data(fmt::format("it contains words in {} cells, but the lines before have numbers in {} cells: "
                                  "another table may begin there",
                                  count, columns_ + (trailing_ ? 1 : 0)),
                      "write each table to its own file", place(line.number));
    }
    const bool commas = head_.separator == ',' && line.text.find('.') == line.text.npos;
    return bad_data(
        fmt::format("the line has {} cells, the lines before have {}", count, columns_ + (trailing_ ? 1 : 0)),
        commas ? "write one cell per column in every line; if commas are also decimal points, export with semicolons "
                 "between the columns"
               : "write one cell per column in every line",
        place(line.number));
  }

  /// Lines that were taken.
  struct Rows {
    std::size_t count = 0;
    const char* end = nullptr;  ///< behind them
  };

  /// Takes lines as nearly all are, whole ones of plain numbers alone, as many as there are one after another.
  /// @param end  of the text that is there
  Rows take_plain_rows(const char* at, const char* end) {
    Rows rows{0, at};
    if (head_.separator == kBlanks || decimal_commas_ || trailing_) return rows;
    while (const char* const behind = take_plain_row(rows.end, end)) {
      rows_.next_row();
      ++rows.count;
      rows.end = behind;
    }
    return rows;
  }

  /// @returns  the begin of the next line; nullptr where this one is not as nearly all are
  const char* take_plain_row(const char* at, const char* end) {
    for (std::size_t c = 0; c < columns_; ++c) {
      const NumberAhead ahead = plain_number_ahead(at, end);
      at += ahead.length;
      if (ahead.length == 0 || at == end) return nullptr;
      keep(c, {at - ahead.length, ahead.length}, ahead.value);
      if (c + 1 < columns_ && *at++ != head_.separator) return nullptr;
    }
    if (line_end_ == '\n') {
      while (at != end && *at == '\r') ++at;
    }
    return at != end && *at == line_end_ ? at + 1 : nullptr;
  }

  /// The number of a cell in the row that is worked on.
  void keep(std::size_t column, std::string_view cell, double value) {
    rows_[column] = value;
    if (std::abs(value) >= kExactWhole) [[unlikely]]
      kinds_[column].rests.put(row_index(), rest_of_cell(cell));
  }
  [[nodiscard]] std::size_t row_index() const { return static_cast<std::size_t>(rows_.rows()); }

  /// A line, as far as it is known.
  struct Row {
    std::size_t count = 0;  ///< cells
    bool odd = false;       ///< a cell is not a number with a decimal point
    bool last_is_empty = false;
  };

  /// Takes a line as most are.
  /// @param end  of the text that is there
  Row take_plain(std::string_view line, const char* end) {
    Row row;
    const auto take = [&](std::string_view cell, std::optional<double> value) {
      ++row.count;
      row.last_is_empty = value && std::isnan(*value) && without_quotes(cell).empty();
      if (row.count > columns_) return row.count <= columns_ + 64;
      row.odd = row.odd || !value;
      keep(row.count - 1, cell, value.value_or(kNone));
      return true;
    };
    if (head_.separator == kBlanks) {
      for_each_cell(line, kBlanks, [&](std::string_view cell) { return take(cell, cell_number(cell)); });
      return row;
    }
    for (;;) {
      // A number ends before a line end, so that it may be looked for beyond the line.
      const NumberAhead ahead = plain_number_ahead(line.data(), end);
      std::size_t length = ahead.length;
      const bool plain = length > 0 && (length == line.size() || line[length] == head_.separator);
      if (!plain) length = std::min(line.find(head_.separator), line.size());
      const std::string_view cell = line.substr(0, length);
      if (!take(cell, plain ? ahead.value : general_number(cell)) || length == line.size()) return row;
      line.remove_prefix(length + 1);
    }
  }

  /// A cell of a line that is not as most are.
  struct Odd {
    enum Kind { number, comma, time, words };
    std::string_view cell;
    Kind kind = words;
    double value = kNone;
    bool sure = false;  ///< a comma is that of decimals
    std::optional<Instant> instant = {};
  };

  Row part_odd(std::string_view line) {
    odd_.clear();
    Row row{0, true, false};
    const auto take = [&](std::string_view cell) {
      ++row.count;
      row.last_is_empty = without_quotes(cell).empty();
      if (row.count <= columns_) odd_.push_back(odd(cell));
      return row.count <= columns_ + 64;
    };
    if (line.find('"') == line.npos) {
      for_each_cell(line, head_.separator, take);
    } else {
      for (const std::string_view cell : quoted_cells(line, head_.separator, columns_ + 64)) take(cell);
    }
    return row;
  }

  /// "0.5,1.5 # touched": a line whose numbers a comment follows. Any other as it is.
  Row without_comment(const CsvLine& line, const char* end, Row row) {
    const auto mark = line.text.find(" #");
    if (mark == line.text.npos || decimal_commas_ || line.text.find('"') != line.text.npos) return row;
    const Row bare = take_plain(line.text.substr(0, mark), end);
    if (!bare.odd && bare.count == columns_) {
      if (commented_++ == 0) first_commented_ = line.number;
      return bare;
    }
    return row.odd ? part_odd(line.text) : take_plain(line.text, end);
  }

  [[nodiscard]] Odd odd(std::string_view cell) const {
    if (!decimal_commas_) {
      if (const auto value = cell_number(cell)) return {cell, Odd::number, *value};
    }
    if (decimal_commas_ || head_.separator != ',' || cell.find('"') != cell.npos) {
      if (const auto value = comma_number(cell)) {
        return {cell, value->has_comma ? Odd::comma : Odd::number, value->value, value->sure};
      }
    }
    if (const auto time = instant(cell)) return {cell, Odd::time, kNone, false, time};
    return {cell};
  }

  Result<void> take_odd(const CsvLine& line) {
    for (std::size_t c = 0; c < odd_.size(); ++c) {
      Odd& one = odd_[c];
      if (one.kind == Odd::comma) {
        MBK_TRY(take_comma(line, c));
      } else if (one.kind == Odd::time) {
        one.value = seconds(kinds_[c], *one.instant);
      } else if (one.kind == Odd::words && !kinds_[c].obstacle) {
        kinds_[c].obstacle = not_a_number(line.number, c + 1, one.cell, decimal_commas_);
      }
    }
    for (std::size_t c = 0; c < odd_.size(); ++c) keep(c, odd_[c].cell, odd_[c].value);
    return {};
  }

  /// A decimal comma: from then on every number has one, and none before had a point.
  Result<void> take_comma(const CsvLine& line, std::size_t column) {
    comma_is_sure_ = comma_is_sure_ || odd_[column].sure;
    if (decimal_commas_) return {};
    comma_cell_ = std::string(without_quotes(odd_[column].cell));
    const auto has_point = [](const Odd& one) {
      return one.kind == Odd::number && one.cell.find('.') != one.cell.npos;
    };
    bool points = std::ranges::any_of(odd_, has_point);
    for (std::size_t c = 0; c < columns_ && !points; ++c) {
      if (kinds_[c].instants > 0) continue;
      points = std::ranges::any_of(rows_.column(c),
                                   [](double value) { return std::isfinite(value) && value != std::trunc(value); });
    }
    if (points) {
      return bad_data(fmt::format("'{}' has a comma, but other numbers have decimal points", printable(comma_cell_)),
                      "the comma is ambiguous: export with decimal points and without thousands separators",
                      fmt::format("line {}, column {}", line.number, column + 1));
    }
    decimal_commas_ = true;
    return {};
  }

  /// [s] since the midnight before the first.
  static double seconds(CsvColumn& column, const Instant& instant) {
    constexpr double kDay = 86'400.0;
    const bool first = column.instants++ == 0;
    if (first) column.dates = instant.day.has_value(), column.first_day = instant.day.value_or(0);
    column.mixed = column.mixed || column.dates != instant.day.has_value();
    if (instant.day) return kDay * static_cast<double>(*instant.day - column.first_day) + instant.seconds;
    if (!first && instant.seconds < column.latest - kDay / 2.0) ++column.midnights;
    column.latest = instant.seconds;
    return kDay * column.midnights + instant.seconds;
  }

  Result<void> finish() {
    if (decimal_commas_ && !comma_is_sure_) {
      return bad_data(
          fmt::format("the comma in '{}' and similar numbers may be a decimal comma or a thousands separator",
                      printable(comma_cell_)),
          "export with decimal points and without thousands separators");
    }
    if (decimal_commas_) head_.notes.emplace_back("numbers have decimal commas");
    head_.notes.insert(head_.notes.end(), unread_.begin(), unread_.end());
    if (commented_ > 0) {
      head_.notes.push_back(fmt::format("comments after the numbers in {} lines, from line {} on, were ignored",
                                        commented_, first_commented_));
    }
    if (trailing_) head_.notes.emplace_back("every line ends with a separator, which was not counted as a column");
    contents.notes.insert(contents.notes.begin(), head_.notes.begin(), head_.notes.end());
    const Error* first = nullptr;
    bool any = false;
    std::vector<std::string> aside;
    for (std::size_t c = 0; c < columns_; ++c) {
      Array& array = contents.arrays[c];
      if (!head_.names.empty()) array.name = printable(head_.names[c]);
      MBK_TRY(settle_unit(c));
      if (kinds_[c].obstacle) {
        array.obstacle = std::move(kinds_[c].obstacle);
        if (first == nullptr) first = &*array.obstacle;
        aside.push_back(array.name.empty() ? std::to_string(c + 1) : fmt::format("{} '{}'", c + 1, array.name));
        static_cast<void>(rows_.take(c));
      } else {
        any = true;
        array.values = SharedMatrix::of_column(rows_.take(c));
        array.rests = std::move(kinds_[c].rests);
      }
    }
    if (!any) return tl::unexpected(*first);
    if (!aside.empty()) note_aside(std::move(aside));
    return {};
  }

  /// The unit of a column, as a line under its name says it; that of times.
  Result<void> settle_unit(std::size_t c) {
    CsvColumn& column = kinds_[c];
    Array& array = contents.arrays[c];
    const std::string called = array.name.empty() ? fmt::format("column {}", c + 1) : fmt::format("'{}'", array.name);
    if (column.instants == 0) {
      if (head_.units.empty()) return {};
      const Unit* const in_name = parse_column_name(array.name).unit;
      const Unit* const said = find_unit(head_.units[c]);
      if (in_name != nullptr && said != nullptr && in_name != said) {
        return bad_data(fmt::format("{} is in {} according to its name, but in {} according to the line of units",
                                    called, in_name->name, said->name),
                        "correct the wrong one");
      }
      array.unit = head_.units[c];
      return {};
    }
    const auto empty = rows_.column(c).array().isNaN().count();
    if (column.mixed || column.instants + empty != rows_.rows()) {
      if (!column.obstacle) {
        column.obstacle =
            bad_data(fmt::format("{} mixes times and other numbers, or times with and without a date", called),
                     "write all values in the same form")
                .value();
      }
      return {};
    }
    if (column.obstacle) return {};
    array.unit = "s";
    if (column.dates) {
      const std::chrono::year_month_day day{std::chrono::sys_days(std::chrono::days(column.first_day))};
      contents.notes.push_back(fmt::format(
          "{} contains dates and times, which were read as seconds since {:04}-{:02}-{:02} 00:00", called,
          static_cast<int>(day.year()), static_cast<unsigned>(day.month()), static_cast<unsigned>(day.day())));
    } else {
      std::string note = fmt::format("{} contains times of day, which were read as seconds since midnight", called);
      if (column.midnights > 0) {
        note += column.midnights == 1 ? "; it passes midnight once"
                                      : fmt::format("; it passes midnight {} times", column.midnights);
      }
      contents.notes.push_back(std::move(note));
    }
    return {};
  }

  void note_aside(std::vector<std::string> aside) {
    constexpr std::size_t kListed = 12;
    const std::size_t more = aside.size() > kListed ? aside.size() - kListed : 0;
    aside.resize(aside.size() - more);
    contents.notes.push_back(fmt::format("columns with non-numeric cells were ignored: {}{}", fmt::join(aside, ", "),
                                         more > 0 ? fmt::format(" and {} more", more) : ""));
  }

  /// Columns long enough for every line that can come: one for each line end, and no line is shorter than its cells. Of
  /// a text that is not all there, as many as its first part lets one expect.
  void make_room(const CsvText& text) {
    const std::string_view there = text.so_far();
    const auto ends = static_cast<std::size_t>(std::ranges::count(there, line_end_));
    const double parts = 1.02 * static_cast<double>(text.size()) / static_cast<double>(there.size());
    const auto expected = text.is_complete() ? ends : static_cast<std::size_t>(static_cast<double>(ends) * parts);
    contents.arrays.resize(columns_);
    rows_.expect(static_cast<Index>(columns_), static_cast<Index>(std::min(expected, text.size() / columns_) + 1));
  }

  CsvHead head_;
  std::size_t columns_ = 0;
  std::vector<CsvColumn> kinds_;
  std::vector<Odd> odd_;   ///< the line that is worked on, where it is not as most are
  bool trailing_ = false;  ///< every line ends with a separator
  char line_end_ = '\n';
  bool decimal_commas_ = false, comma_is_sure_ = false;
  std::string comma_cell_;  ///< the first that has one
  TableColumns rows_;       ///< complete ones so far, and the one that is worked on
  std::size_t last_line_ = 0;
  std::vector<std::string> unread_;                  ///< notes of comments among the rows
  std::size_t commented_ = 0, first_commented_ = 0;  ///< lines with a comment behind their numbers
};

Result<Contents> decode_text(CsvText text) {
  Table table;
  MBK_TRY(table.read(text));
  return std::move(table.contents);
}

/// UTF-16 behind its byte order mark as UTF-8.
std::string from_utf16(std::span<const std::byte> file) {
  const auto at = [&](std::size_t k) { return std::to_integer<unsigned>(file[k]); };
  const std::size_t low = at(0) == 0xFF ? 0 : 1;
  std::u16string text;
  text.reserve(file.size() / 2);
  for (std::size_t k = 2; k + 1 < file.size(); k += 2) {
    text += static_cast<char16_t>(at(k + low) | (at(k + 1 - low) << 8U));
  }
  return utf8_from_utf16(text);
}

}  // namespace

bool looks_like_utf16(std::span<const std::byte> file) {
  if (file.size() < 4) return false;
  const auto first = std::to_integer<unsigned>(file[0]), second = std::to_integer<unsigned>(file[1]);
  return (first == 0xFF && second == 0xFE) || (first == 0xFE && second == 0xFF);
}

Result<Contents> decode_csv(std::span<const std::byte> file) {
  if (!looks_like_utf16(file)) {
    return decode_text(CsvText({reinterpret_cast<const char*>(file.data()), file.size()}));
  }
  const std::string text = from_utf16(file);
  if (std::ranges::any_of(text, [](char c) { return c >= 0 && c < ' ' && c != '\t' && c != '\n' && c != '\r'; })) {
    return bad_data("the file has no known format and is not text", "export the table as text");
  }
  auto contents = decode_text(CsvText(text));
  if (contents) contents->notes.insert(contents->notes.begin(), "its text is UTF-16");
  return contents;
}

Result<Contents> decode_csv(FileInPassing& file) {
  return decode_text(CsvText(file));
}

}  // namespace mbk::recording
