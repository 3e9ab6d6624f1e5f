#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/csv_text.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/preamble.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kFew = 40, kMany = 2000;  ///< lines that are looked at: at first, and where these do not suffice
constexpr auto kSeparators = std::to_array<char>({';', '\t', '|', ',', kBlanks});

enum class Cell { empty, missing, number, text };

bool is_missing_word(std::string_view cell) {
  constexpr auto kWords =
      std::to_array<std::string_view>({"NA", "N/A", "n/a", "na", "#N/A", "null", "NULL", "None", "-", "--", "true",
                                       "false", "True", "False", "TRUE", "FALSE"});
  return std::ranges::find(kWords, cell) != kWords.end();
}

Cell kind_of(std::string_view cell, char separator) {
  const bool in_quotes = mbk::trimmed(cell, " \t").starts_with('"');
  if (cell_number(cell)) return without_quotes(cell).empty() ? Cell::empty : Cell::number;
  if ((separator != ',' || in_quotes) && comma_number(cell)) return Cell::number;
  if (instant(cell)) return Cell::number;
  return is_missing_word(without_quotes(cell)) ? Cell::missing : Cell::text;
}

/// A line under one separator.
struct Parted {
  const CsvLine* line = nullptr;
  std::vector<Cell> cells;
  std::size_t numbers = 0, texts = 0;

  [[nodiscard]] std::size_t filled() const {
    return cells.size() - static_cast<std::size_t>(std::ranges::count(cells, Cell::empty));
  }
  [[nodiscard]] bool is_words() const { return numbers == 0 && texts > 0; }
  /// Nothing that a header could hold.
  [[nodiscard]] bool is_bare() const { return texts == 0 && numbers > 0; }
};

Parted part(const CsvLine& line, char separator) {
  Parted parted{&line, {}, 0, 0};
  const auto take = [&](std::string_view cell) {
    const Cell kind = kind_of(cell, separator);
    parted.cells.push_back(kind);
    parted.numbers += kind == Cell::number ? 1 : 0;
    parted.texts += kind == Cell::text ? 1 : 0;
    return parted.cells.size() < kMaxCells;
  };
  if (line.text.find('"') == line.text.npos) {
    for_each_cell(line.text, separator, take);
  } else {
    for (const std::string_view cell : quoted_cells(line.text, separator, kMaxCells)) take(cell);
  }
  return parted;
}

/// The lines as one separator parts them.
struct Reading {
  char separator = ',';
  std::vector<Parted> lines;
  std::size_t width = 0;  ///< cells of a row
  double score = 0.0;     ///< share of the cells that are numbers in rows of this width
  bool named = false;     ///< a line of words has as many cells as the rows

  [[nodiscard]] bool is_row(const Parted& line) const {
    return line.is_bare() || (line.cells.size() == width && !line.is_words());
  }
};

Reading reading(const std::vector<CsvLine>& lines, char separator) {
  Reading found{separator, {}, 0, 0.0};
  struct Width {
    std::size_t lines = 0, numbers = 0;
  };
  std::map<std::size_t, Width> widths;
  std::size_t cells = 0;
  for (const CsvLine& line : lines) {
    found.lines.push_back(part(line, separator));
    const Parted& parted = found.lines.back();
    cells += parted.filled();
    if (parted.numbers == 0) continue;
    Width& width = widths[parted.cells.size()];
    width.lines += line.terminated ? 2 : 1;
    width.numbers += parted.numbers;
  }
  if (widths.empty()) return found;
  const auto most = std::ranges::max_element(
      widths, {}, [](const auto& width) { return std::pair(width.second.lines, width.second.numbers); });
  found.width = most->first;
  found.score = static_cast<double>(most->second.numbers) / static_cast<double>(std::max<std::size_t>(cells, 1));
  found.named = found.width > 1 && std::ranges::any_of(found.lines, [&](const Parted& line) {
                  return line.is_words() && line.cells.size() == found.width;
                });
  return found;
}

/// The separator under which most is a number.
Reading best_reading(const std::vector<CsvLine>& lines) {
  Reading best = reading(lines, ',');
  for (const char separator : kSeparators) {
    const auto has = [separator](const CsvLine& line) {
      return separator == kBlanks ? mbk::trimmed(line.text, " \t").find_first_of(" \t") != line.text.npos
                                  : line.text.find(separator) != line.text.npos;
    };
    if (separator == ',' || std::ranges::none_of(lines, has)) continue;
    Reading other = reading(lines, separator);
    const bool earlier = separator != kBlanks;  // than the comma, where both will do
    const bool several = other.width > 1 && (earlier || best.width <= 1);
    // In "2024-03-01 10:15:30,5" a blank may part two numbers and a comma too: the header decides.
    constexpr double kAlike = 0.25;
    if (other.named != best.named && other.score > 0.0 && best.score > 0.0 &&
        std::abs(other.score - best.score) < kAlike) {
      if (other.named) best = std::move(other);
      continue;
    }
    if (other.score > best.score || (other.score > 0.0 && other.score == best.score && several && best.width <= 1)) {
      best = std::move(other);
    }
  }
  return best;
}

std::vector<std::string> texts_of(std::string_view line, char separator) {
  std::vector<std::string> texts;
  for (const std::string_view cell : quoted_cells(line, separator, kMaxCells)) {
    std::string& text = texts.emplace_back(without_quotes(cell));
    for (auto at = text.find("\"\""); at != text.npos; at = text.find("\"\"", at + 1)) text.erase(at, 1);
  }
  return texts;
}

/// "mm" of "[mm]", "(mm)" and "mm"; "" of "-".
std::string_view bare_unit(std::string_view cell) {
  cell = mbk::trimmed(cell, " \t");
  if (cell.size() >= 2 &&
      ((cell.front() == '[' && cell.back() == ']') || (cell.front() == '(' && cell.back() == ')'))) {
    cell = mbk::trimmed(cell.substr(1, cell.size() - 2));
  }
  return cell == "-" || cell == "--" ? std::string_view() : cell;
}

/// Whether a line under the names says their units: most of its words are units, and none is the name of a channel.
bool says_units(const std::vector<std::string>& cells) {
  constexpr std::size_t kLongestUnit = 16;
  std::size_t words = 0, units = 0;
  for (const std::string& cell : cells) {
    const std::string_view unit = bare_unit(cell);
    if (unit.size() > kLongestUnit || !kinds_called(unit).empty()) return false;
    words += unit.empty() ? 0 : 1;
    units += find_unit(unit) != nullptr ? 1 : 0;
  }
  return units > 0 && 2 * units >= words;
}

std::string_view name_of(char separator) {
  switch (separator) {
    case ';':
      return "semicolons";
    case '\t':
      return "tabs";
    case '|':
      return "vertical bars";
    case kBlanks:
      return "blanks";
    default:
      return "commas";
  }
}

class HeadFinder {
 public:
  explicit HeadFinder(CsvText& text) : text_(text) {}

  Result<CsvHead> run() {
    CsvLines lines(text_);
    read_lines(lines, kFew);
    if (!text_.status()) return tl::unexpected(text_.status().error());
    reading_ = choose();
    if (!is_settled()) {
      read_lines(lines, kMany);
      if (!text_.status()) return tl::unexpected(text_.status().error());
      reading_ = choose();
    }
    head_.separator = reading_.separator;
    MBK_TRY(find_rows());
    if (head_.first_row > 0 && head_.names.empty()) {
      MBK_TRY(check_headless());
    }
    note();
    return std::move(head_);
  }

 private:
  void read_lines(CsvLines& lines, std::size_t most) {
    while (lines_.size() < most) {
      auto line = lines.next_of_all();
      if (!line) {
        all_ = true;
        return;
      }
      if (line->number == 1 && line->text.size() == 5 && line->text.starts_with("sep=")) {
        said_ = line->text.back();
        continue;
      }
      if (line->text.find_first_not_of(" \t") == line->text.npos) continue;
      if (is_comment(line->text)) {
        comment_ = *line;
        if (comments_.size() < kMany) comments_.push_back(*line);
        continue;
      }
      lines_.push_back(*line);
      comments_above_.push_back(std::exchange(comment_, std::nullopt));
    }
  }

  [[nodiscard]] Reading choose() const {
    if (said_ != 0) return reading(lines_, said_);
    return best_reading(lines_);
  }

  /// Whether the last lines are rows, so that the table continues from here.
  [[nodiscard]] bool is_settled() const {
    constexpr std::size_t kEnough = 3;
    if (all_) return true;
    std::size_t rows = 0;
    for (auto line = reading_.lines.rbegin(); line != reading_.lines.rend() && reading_.is_row(*line); ++line) ++rows;
    return rows >= kEnough;
  }

  Result<void> find_rows() {
    const std::vector<Parted>& lines = reading_.lines;
    std::size_t last = lines.size();
    while (last > 0 && !(lines[last - 1].numbers > 0 && reading_.is_row(lines[last - 1]))) --last;
    if (last == 0) return {};
    std::size_t first = last - 1;
    while (first > 0 && reading_.is_row(lines[first - 1]) && !states(lines[first - 1])) --first;
    std::size_t above = first;  // lines above the table and its header
    const bool stated = first > 0 && states(lines[first - 1]);
    if (first > 0 && !stated && is_header(lines[first - 1], lines[first])) {
      above = take_header(first - 1);
    } else if (is_header_with_numbers(first, last)) {
      head_.names = texts_of(lines[first].line->text, reading_.separator);
      head_.header_line = lines[first].line->number;
      ++first;
    } else if (first > 0 && !stated && lines[first - 1].cells.size() > 1 && reading_.separator != kBlanks) {
      above = take_header(first - 1);  // does not fit; reported where the columns are counted
    } else {
      take_comment(first);
    }
    head_.first_row = lines[first].line->number;
    return check_above(above);
  }

  /// Whether a line says a rate or a unit, as "Fs,1000": it then is neither a row nor a header.
  [[nodiscard]] static bool states(const Parted& line) { return line.texts > 0 && is_statement(*line.line); }

  /// "Channels,5,Gain,2": words and numbers in turns.
  [[nodiscard]] static bool is_pairs(const Parted& line) {
    std::size_t last = line.cells.size();
    while (last > 0 && line.cells[last - 1] == Cell::empty) --last;
    for (std::size_t c = 0; c < last; ++c) {
      if ((line.cells[c] == Cell::text) != (c % 2 == 0)) return false;
    }
    return true;
  }

  [[nodiscard]] static bool is_header(const Parted& line, const Parted& row) {
    const std::size_t names = line.cells.size(), columns = row.cells.size();
    const bool row_ends_empty = columns > 1 && row.cells.back() == Cell::empty;
    return line.is_words() && (names == columns || (row_ends_empty && names + 1 == columns) ||
                               (line.cells.back() == Cell::empty && names == columns + 1));
  }

  /// The header, or what says its units and above it the header.
  /// @returns  lines above
  std::size_t take_header(std::size_t at) {
    const Parted& line = reading_.lines[at];
    std::vector<std::string> cells = texts_of(line.line->text, reading_.separator);
    if (at > 0 && says_units(cells)) {
      const Parted& names = reading_.lines[at - 1];
      if (names.is_words() && names.cells.size() == line.cells.size()) {
        for (std::string& cell : cells) cell = printable(std::string(bare_unit(cell)));
        head_.units = std::move(cells);
        head_.notes.push_back(fmt::format("line {} was read as the units of the columns", line.line->number));
        cells = texts_of(names.line->text, reading_.separator);
        --at;
      }
    }
    head_.names = std::move(cells);
    head_.header_line = reading_.lines[at].line->number;
    return join_names(at);
  }

  /// Names in two lines, "hand,,force," above "x,y,x,y": where those of the lower line do not tell the columns apart.
  /// @returns  lines above
  std::size_t join_names(std::size_t at) {
    const Parted& line = reading_.lines[at];
    if (at == 0 || are_different(head_.names)) return at;
    const Parted& above = reading_.lines[at - 1];
    if (!above.is_words() || above.cells.size() != line.cells.size() || states(above)) return at;
    std::vector<std::string> joined = texts_of(above.line->text, reading_.separator);
    std::string group;
    for (std::size_t c = 0; c < joined.size(); ++c) {
      if (!joined[c].empty()) group = joined[c];
      const std::string& name = head_.names[c];
      joined[c] = name.empty() ? joined[c] : group.empty() ? name : group + "_" + name;
    }
    if (!are_different(joined)) return at;
    head_.notes.push_back(
        fmt::format("lines {} and {} were combined into the column names", above.line->number, line.line->number));
    head_.names = std::move(joined);
    return at - 1;
  }

  static bool are_different(std::vector<std::string> names) {
    while (!names.empty() && names.back().empty()) names.pop_back();  // behind a separator at the end
    std::ranges::sort(names);
    return std::ranges::adjacent_find(names) == names.end();
  }

  /// Whether the first row has texts where all others have numbers.
  [[nodiscard]] bool is_header_with_numbers(std::size_t first, std::size_t last) const {
    const Parted& line = reading_.lines[first];
    if (line.texts == 0) return false;
    for (std::size_t c = 0; c < line.cells.size(); ++c) {
      if (line.cells[c] != Cell::text) continue;
      bool number = false;
      for (std::size_t k = first + 1; k < last; ++k) {
        const Parted& row = reading_.lines[k];
        if (c >= row.cells.size()) continue;
        if (row.cells[c] == Cell::text) return false;
        number = number || row.cells[c] == Cell::number;
      }
      if (!number) return false;
    }
    return true;
  }

  /// Names in a comment just above the table, as numpy.savetxt writes them.
  void take_comment(std::size_t first) {
    const std::optional<CsvLine>& above = comments_above_[first];
    if (!above) return;
    std::string_view text = mbk::trimmed(above->text, " \t");
    while (text.starts_with('#') || text.starts_with('%')) text.remove_prefix(1);
    text = mbk::trimmed(text, " \t");
    const CsvLine bare{above->number, text, true};
    const Parted parted = part(bare, reading_.separator);
    if (!is_header(parted, reading_.lines[first]) || parted.cells.size() < 2) return;
    auto names = texts_of(text, reading_.separator);
    const auto known =
        std::ranges::count_if(names, [](const std::string& name) { return !parse_column_name(name).kinds.empty(); });
    if (known < (reading_.separator == kBlanks ? 2 : 1)) return;
    head_.names = std::move(names);
    head_.header_line = above->number;
    head_.notes.push_back(fmt::format("the column names were read from the comment in line {}", above->number));
  }

  /// Lines above the table must be text.
  Result<void> check_above(std::size_t above) {
    std::size_t lines = 0;
    for (std::size_t k = 0; k < above; ++k) {
      const Parted& line = reading_.lines[k];
      if (line.is_bare() ||
          (line.numbers > 1 && line.cells.size() == reading_.width && reading_.width > 2 && !is_pairs(line))) {
        return bad_data(
            fmt::format("there are numbers above the header in line {}; the file may contain several tables",
                        head_.header_line > 0 ? head_.header_line : head_.first_row),
            "write each table to its own file", fmt::format("line {}", line.line->number));
      }
      ++lines;
      head_.above.push_back(*line.line);
    }
    if (!text_.so_far().starts_with(fmt::format("# {}", kLayout))) {  // our own writer's, which are read as such
      const auto is_above = [&](const CsvLine& comment) {
        return comment.number < head_.first_row && comment.number != head_.header_line;
      };
      std::ranges::copy_if(comments_, std::back_inserter(head_.above), is_above);
      std::ranges::sort(head_.above, {}, &CsvLine::number);
    }
    if (lines > 0) {
      head_.notes.push_back(fmt::format("{} above the table {} ignored",
                                        lines == 1 ? "a line of text" : fmt::format("{} lines of text", lines),
                                        lines == 1 ? "was" : "were"));
    }
    return {};
  }

  /// Commas as both separator and decimal point, as in "0,001,1,5".
  [[nodiscard]] Result<void> check_headless() const {
    if (reading_.separator != ',' || reading_.width < 2 || reading_.width % 2 != 0) return {};
    bool leading_zero = false;
    for (const Parted& line : reading_.lines) {
      if (line.line->number < head_.first_row) continue;
      if (line.line->text.find_first_not_of("0123456789,+- \t") != line.line->text.npos) return {};
      std::size_t k = 0;
      for_each_cell(line.line->text, ',', [&](std::string_view cell) {
        cell = mbk::trimmed(cell, " \t");
        leading_zero = leading_zero || (k % 2 == 1 && cell.size() > 1 && cell.front() == '0');
        return ++k < kMaxCells;
      });
    }
    if (!leading_zero) return {};
    return bad_data("the commas could separate columns or be decimal points",
                    "export with semicolons or tabs between the columns, with decimal points, or with a header",
                    fmt::format("line {}", head_.first_row));
  }

  void note() {
    if (said_ != 0) head_.notes.push_back("the first line states the column separator");
    if (reading_.separator != ',' && (reading_.width > 1 || said_ != 0)) {
      head_.notes.insert(head_.notes.begin(), fmt::format("columns are separated by {}", name_of(reading_.separator)));
    }
  }

  CsvText& text_;
  std::vector<CsvLine> lines_;
  std::vector<std::optional<CsvLine>>
      comments_above_;              ///< of each line, the last comment between it and the one before
  std::optional<CsvLine> comment_;  ///< since the last line
  std::vector<CsvLine> comments_;   ///< the first of all
  char said_ = 0;                   ///< by "sep=;" in the first line
  bool all_ = false;                ///< these are all lines that there are
  Reading reading_;
  CsvHead head_;
};

}  // namespace

std::vector<std::string_view> quoted_cells(std::string_view line, char separator, std::size_t most) {
  std::vector<std::string_view> cells;
  const auto is_separator = [separator](char c) { return c == separator || (separator == kBlanks && c == '\t'); };
  std::size_t at = 0;
  while (cells.size() < most) {
    if (separator == kBlanks) {
      at = std::min(line.find_first_not_of(" \t", at), line.size());
      if (at == line.size()) break;
    }
    const std::size_t begin = at;
    const std::size_t mark = std::min(line.find_first_not_of(separator == '\t' ? " " : " \t", at), line.size());
    if (mark < line.size() && line[mark] == '"') {
      at = mark + 1;
      while (at < line.size() && !(line[at] == '"' && (at + 1 == line.size() || line[at + 1] != '"'))) {
        at += line[at] == '"' ? 2 : 1;
      }
      at = std::min(at + 1, line.size());
    }
    while (at < line.size() && !is_separator(line[at])) ++at;
    cells.push_back(line.substr(begin, at - begin));
    if (at == line.size()) break;
    ++at;
  }
  return cells;
}

Result<CsvHead> find_table(CsvText& text) {
  return HeadFinder(text).run();
}

}  // namespace mbk::recording
