#include "mbk/files/tables/text_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {
namespace {

/// "0.52,0.43,0.1,0.7": what OpenSim writes of a rotation or a direction. Two numbers may be one with a decimal comma.
bool is_vector(std::string_view cell) {
  const auto parts = split(mbk::trimmed(cell, " \t~[]()"), ',');
  return parts.size() > 2 && std::ranges::all_of(parts, [](std::string_view part) {
           return !is_blank(part) && cell_number(mbk::trimmed(part, " \t"));
         });
}

std::optional<double> with_decimal_comma(std::string_view cell) {
  const auto number = comma_number(cell);
  return number ? std::optional(number->value) : std::nullopt;
}

}  // namespace

std::string in_lower_case(std::string_view text) {
  std::string lower(mbk::trimmed(text, " \t"));
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return lower;
}

std::string line_place(std::size_t line) {
  return fmt::format("line {}", line);
}

bool is_blank(std::string_view cell) {
  return cell.find_first_not_of(" \t") == cell.npos;
}

bool is_empty_row(std::string_view line) {
  return line.find_first_not_of(" \t,;\"") == line.npos;
}

std::string label_of(std::string_view cell) {
  return printable(std::string(without_quotes(cell)));
}

char separator_of(std::string_view line) {
  for (const char separator : {'\t', ';', ','}) {
    if (line.find(separator) != line.npos) return separator;
  }
  return ' ';
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  return separator != ' ' && line.find(separator) != line.npos ? split(line, separator) : words(line);
}

std::vector<std::string_view> filled_cells_of(std::string_view line, char separator) {
  auto cells = cells_of(line, separator);
  while (!cells.empty() && is_blank(cells.back())) cells.pop_back();
  return cells;
}

std::optional<double> positive_number(std::string_view text) {
  const auto value = general_number(text);
  return value && *value > 0.0 && *value < 1e300 ? value : std::nullopt;
}

bool is_cut(const TextLine& line, std::size_t cells, std::size_t columns) {
  return !line.terminated && cells < columns;
}

std::string note_of_cut(const TextLine& line) {
  return fmt::format("line {} is incomplete (the recording was cut off there) and was ignored", line.number);
}

void compare_counts(const std::optional<double>& said, std::size_t there, std::string_view what, Contents& contents) {
  if (!said || *said == static_cast<double>(there)) return;
  contents.notes.push_back(fmt::format("the header states {} {}, but there are {}{}", *said, what, there,
                                       *said > static_cast<double>(there) ? ": the file may be truncated" : ""));
}

void number_repeated(std::vector<std::string>& names) {
  std::map<std::string, int> copies;
  for (std::string& name : names) {
    if (const int copy = ++copies[name]; copy > 1) name += fmt::format("#{}", copy);
  }
}

void note_obstacles(std::string_view what, Contents& contents) {
  std::vector<std::string> names;
  for (const Array& array : contents.arrays) {
    if (array.obstacle) names.push_back(array.name);
  }
  if (names.empty()) return;
  constexpr std::size_t kListed = 12;
  const std::size_t more = names.size() > kListed ? names.size() - kListed : 0;
  names.resize(names.size() - more);
  contents.notes.push_back(fmt::format("columns with {} were ignored: {}{}", what, fmt::join(names, ", "),
                                       more > 0 ? fmt::format(" and {} more", more) : ""));
}

std::string_view text_of(std::span<const std::byte> file) {
  return {reinterpret_cast<const char*>(file.data()), file.size()};
}

/// The cells of a line that says names, which may stand in quotes and hold separators there.
std::vector<std::string> labels_of(std::string_view line, char separator) {
  std::vector<std::string> labels;
  for (;;) {
    std::size_t end = line.find(separator);
    if (const auto first = line.find_first_not_of(' '); first != line.npos && line[first] == '"') {
      const auto close = line.find('"', first + 1);
      end = close == line.npos ? line.npos : line.find(separator, close);
    }
    end = std::min(end, line.size());
    labels.push_back(label_of(line.substr(0, end)));
    if (end == line.size()) return labels;
    line.remove_prefix(end + 1);
  }
}

/// Adds a row, whatever stands for its decimal points.
Result<void> add_row(TextRows& rows, const TextLine& line, char separator, std::size_t columns) {
  auto cells = split(line.text, separator);
  while (cells.size() > columns && is_blank(cells.back())) cells.pop_back();
  if (cells.size() > columns) {
    return bad_data(fmt::format("the line has {} cells, but the header names {} columns", cells.size(), columns),
                    std::string(kWriteAgain), line_place(line.number));
  }
  return rows.add(line, cells, separator != ',' && line.text.find(',') != line.text.npos);
}

Array& add_array(Contents& contents, std::string name, std::string unit, double rate_hz) {
  Array& array = contents.arrays.emplace_back();
  array.name = std::move(name);
  array.unit = std::move(unit);
  array.rate_hz = rate_hz;
  return array;
}

TextRows::TextRows(std::size_t columns, std::size_t bytes)
    : numbers_(columns),
      obstacles_(columns),
      most_(largest_claim(bytes) / (sizeof(double) * std::max<std::size_t>(columns, 1))) {}

Result<void> TextRows::add(const TextLine& line, std::span<const std::string_view> cells, bool decimal_commas) {
  if (count() >= most_) {
    return bad_data(
        fmt::format("most lines contain far fewer numbers than the {} columns in the header", numbers_.size()),
        std::string(kWriteAgain), line_place(line.number));
  }
  for (std::size_t c = 0; c < numbers_.size(); ++c) {
    auto value = c >= cells.size() ? std::optional(std::numeric_limits<double>::quiet_NaN())
                 : decimal_commas  ? with_decimal_comma(cells[c])
                                   : cell_number(cells[c]);
    if (!value) {
      const std::string cell = printable(std::string(cells[c].substr(0, 40)));
      const std::string where = fmt::format("line {}, column {}", line.number, c + 1);
      if (decimal_commas || !is_vector(cells[c])) {
        return bad_data(fmt::format("'{}' is not a number", cell), std::string(kWriteAgain), where);
      }
      if (!obstacles_[c]) {
        obstacles_[c] =
            bad_data(fmt::format("'{}' is a vector", cell), "write each of its numbers in its own column", where)
                .value();
      }
      value = std::numeric_limits<double>::quiet_NaN();
    }
    numbers_[c].push_back(*value);
  }
  return {};
}

void TextRows::give(std::size_t c, Array& array) {
  array.obstacle = std::move(obstacles_[c]);
  if (!array.obstacle) {
    array.values = SharedMatrix::of_column(
        Vector(Eigen::Map<const Vector>(numbers_[c].data(), static_cast<Index>(numbers_[c].size()))));
  }
  numbers_[c] = {};
}

}  // namespace mbk::recording
