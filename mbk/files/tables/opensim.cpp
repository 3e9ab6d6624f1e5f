#include "mbk/files/tables/opensim.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/text_lines.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxColumns = 10'000;
constexpr std::string_view kWriteAgain = "write it again with the program that made it";
constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::string in_lower_case(std::string_view text) {
  std::string lower(mbk::trimmed(text, " \t"));
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return lower;
}

std::string line_place(std::size_t line) {
  return fmt::format("line {}", line);
}

std::optional<double> positive_number(std::string_view text) {
  const auto value = general_number(text);
  return value && *value > 0.0 && *value < 1e300 ? value : std::nullopt;
}

/// "0.52,0.43,0.1,0.7": what OpenSim writes of a rotation or a direction. Two numbers may be one with a decimal comma.
bool is_vector(std::string_view cell) {
  const auto parts = split(mbk::trimmed(cell, " \t~[]()"), ',');
  return parts.size() > 2 && std::ranges::all_of(parts, [](std::string_view part) {
           part = mbk::trimmed(part, " \t");
           return !part.empty() && cell_number(part).has_value();
         });
}

/// Rows of numbers, each as long as there are columns.
class Rows {
 public:
  explicit Rows(std::size_t columns) : numbers_(columns), obstacles_(columns) {}

  Result<void> add(const TextLine& line, const std::vector<std::string_view>& cells) {
    for (std::size_t c = 0; c < numbers_.size(); ++c) {
      auto value = c < cells.size() ? cell_number(cells[c]) : kMissing;
      if (!value) {
        const std::string cell = printable(std::string(cells[c].substr(0, 40)));
        const std::string where = fmt::format("line {}, column {}", line.number, c + 1);
        if (!is_vector(cells[c])) {
          return bad_data(fmt::format("'{}' is not a number", cell), std::string(kWriteAgain), where);
        }
        if (!obstacles_[c]) {
          obstacles_[c] =
              bad_data(fmt::format("'{}' is a vector", cell), "write each of its numbers as a column of its own", where)
                  .value();
        }
        value = kMissing;
      }
      numbers_[c].push_back(*value);
    }
    return {};
  }

  [[nodiscard]] std::size_t count() const { return numbers_.front().size(); }
  /// Values and obstacle of an array.
  void give(std::size_t c, Array& array) {
    array.obstacle = std::move(obstacles_[c]);
    if (!array.obstacle) {
      array.values = SharedMatrix::of_column(
          Vector(Eigen::Map<const Vector>(numbers_[c].data(), static_cast<Index>(numbers_[c].size()))));
    }
    numbers_[c] = {};
  }

 private:
  std::vector<std::vector<double>> numbers_;
  std::vector<std::optional<Error>> obstacles_;
};

/// "it says 100 rows and holds 98".
void compare_counts(const std::optional<double>& said, std::size_t there, std::string_view what, Contents& contents) {
  if (!said || *said == static_cast<double>(there)) return;
  contents.notes.push_back(fmt::format("the header says {} {}, and there are {}{}", *said, what, there,
                                       *said > static_cast<double>(there) ? ": the file may have been cut off" : ""));
}

/// What stands between the cells of a line: a tab; a semicolon or comma where a spreadsheet saved it; or blanks.
char separator_of(std::string_view line) {
  for (const char separator : {'\t', ';', ','}) {
    if (line.find(separator) != line.npos) return separator;
  }
  return ' ';
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  return separator != ' ' && line.find(separator) != line.npos ? split(line, separator) : words(line);
}

bool is_blank(std::string_view cell) {
  return mbk::trimmed(cell, " \t").empty();
}

/// The same without empty ones at the end.
std::vector<std::string_view> filled_cells_of(std::string_view line, char separator) {
  auto cells = cells_of(line, separator);
  while (!cells.empty() && is_blank(cells.back())) cells.pop_back();
  return cells;
}

void note_vectors(Contents& contents) {
  std::vector<std::string> names;
  for (const Array& array : contents.arrays) {
    if (array.obstacle) names.push_back(array.name);
  }
  if (names.empty()) return;
  constexpr std::size_t kListed = 12;
  const std::size_t more = names.size() > kListed ? names.size() - kListed : 0;
  names.resize(names.size() - more);
  contents.notes.push_back(fmt::format("columns that hold vectors were left aside: {}{}", fmt::join(names, ", "),
                                       more > 0 ? fmt::format(" and {} more", more) : ""));
}

/// Whether the last line was not written completely.
bool is_cut(const TextLine& line, std::size_t cells, std::size_t columns) {
  return !line.terminated && cells < columns;
}

}  // namespace

bool looks_like_opensim(std::string_view text) {
  constexpr std::size_t kLongestHeader = 1 << 16;
  if (text.substr(0, kLongestHeader).find('\0') != text.npos) return false;
  TextLines lines(text.substr(0, kLongestHeader));
  for (auto line = lines.next(); line; line = lines.next()) {
    if (line->number > 1 && in_lower_case(line->text) == "endheader") return true;
  }
  return false;
}

Result<Contents> decode_opensim(std::span<const std::byte> file) {
  TextLines lines({reinterpret_cast<const char*>(file.data()), file.size()});
  Contents contents;
  contents.format = "OpenSim";
  contents.table = true;
  std::map<std::string, std::string> header;
  for (auto line = lines.next(); line; line = lines.next()) {
    const std::string lower = in_lower_case(line->text);
    if (lower == "endheader") break;
    const std::size_t end = std::min(lower.find_first_of("= \t"), lower.size());
    header[lower.substr(0, end)] =
        mbk::trimmed(std::string_view(lower).substr(std::min(end + 1, lower.size())), " \t=");
  }
  const auto labels_line = lines.next_filled();
  if (!labels_line) return bad_data("no labels stand behind 'endheader'", "nothing was recorded, or it was cut off");
  std::vector<std::string> labels;
  const char separator = separator_of(labels_line->text);
  for (const std::string_view cell : filled_cells_of(labels_line->text, separator)) {
    labels.push_back(printable(std::string(mbk::trimmed(cell, " \t"))));
  }
  if (labels.empty() || labels.size() > kMaxColumns || general_number(labels.front())) {
    return bad_data("the line behind 'endheader' holds no labels", std::string(kWriteAgain),
                    line_place(labels_line->number));
  }
  Rows rows(labels.size());
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    auto cells = cells_of(line->text, separator);
    while (cells.size() > labels.size() && is_blank(cells.back())) cells.pop_back();
    if (is_cut(*line, cells.size(), labels.size())) {
      contents.notes.push_back(
          fmt::format("line {} is incomplete (the recording was cut off there) and was ignored", line->number));
      break;
    }
    if (cells.size() != labels.size()) {
      return bad_data(fmt::format("{} numbers where there are {} labels", cells.size(), labels.size()),
                      std::string(kWriteAgain), line_place(line->number));
    }
    if (auto ok = rows.add(*line, cells); !ok) return tl::unexpected(ok.error());
  }
  if (rows.count() == 0) return bad_data("no line of numbers stands behind the labels", "nothing was recorded");
  const auto said = [&](const char* today, const char* old) -> std::optional<double> {
    for (const char* key : {today, old}) {
      if (const auto entry = header.find(key); entry != header.end()) return positive_number(entry->second);
    }
    return std::nullopt;
  };
  compare_counts(said("nrows", "datarows"), rows.count(), "rows", contents);
  compare_counts(said("ncolumns", "datacolumns"), labels.size(), "columns", contents);
  if (const auto entry = header.find("indegrees"); entry == header.end()) {
    contents.notes.emplace_back(
        "the header does not say inDegrees: angles are taken in rad unless --channels says deg");
  } else if (entry->second == "yes") {
    contents.units = {"deg"};
  }
  for (std::size_t c = 0; c < labels.size(); ++c) {
    Array& array = contents.arrays.emplace_back();
    array.name = std::move(labels[c]);
    rows.give(c, array);
  }
  note_vectors(contents);
  return contents;
}

bool looks_like_trc(std::string_view text) {
  return text.starts_with("PathFileType") || text.starts_with("\xEF\xBB\xBFPathFileType");
}

namespace {

/// The header of a TRC file: keys, and below them their values.
class TrcHeader {
 public:
  TrcHeader(std::string_view keys, std::string_view values) {
    const char separator = separator_of(keys);
    auto all = filled_cells_of(keys, separator), their = filled_cells_of(values, separator);
    // A tab too many in one of the lines moves the others: then words count.
    if (all.size() != their.size()) all = filled_words(keys, separator), their = filled_words(values, separator);
    for (std::size_t k = 0; k < std::min(all.size(), their.size()); ++k) {
      said_[in_lower_case(all[k])] = mbk::trimmed(their[k], " \t");
    }
  }
  [[nodiscard]] std::string_view operator[](const std::string& key) const {
    const auto found = said_.find(key);
    return found == said_.end() ? std::string_view() : found->second;
  }

 private:
  static std::vector<std::string_view> filled_words(std::string_view line, char separator) {
    auto cells = cells_of(line, separator);
    std::erase_if(cells, is_blank);
    return cells;
  }
  std::map<std::string, std::string_view> said_;
};

/// "X1 Y1 Z1 X2 …" below the names.
Result<void> check_axes(const TextLine& line, char separator, const std::vector<std::string>& markers,
                        Contents& contents) {
  auto labels = cells_of(line.text, separator);
  std::erase_if(labels, is_blank);
  if (labels.size() != 3 * markers.size()) {
    if (!labels.empty() && !cell_number(labels.front())) return {};
    return bad_data("no line of axes, X1 Y1 Z1, stands below the names", std::string(kWriteAgain),
                    line_place(line.number));
  }
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const std::string label = in_lower_case(labels[k]);
    if (label.front() != "xyz"[k % 3]) {
      return bad_data(fmt::format("'{}' stands where the {} axis of '{}' must", printable(std::string(labels[k])),
                                  "XYZ"[k % 3], markers[k / 3]),
                      std::string(kWriteAgain), line_place(line.number));
    }
    const auto number = cell_number(std::string_view(label).substr(1));
    if (k % 3 == 0 && number && *number != static_cast<double>(k / 3 + 1) && label.size() > 1) {
      contents.notes.push_back(fmt::format("the axes of '{}' are called {}, and its name was taken", markers[k / 3],
                                           printable(std::string(labels[k]))));
    }
  }
  return {};
}

}  // namespace

Result<Contents> decode_trc(std::span<const std::byte> file) {
  constexpr std::string_view kWriteAgain = "write it again with the program that made it";
  TextLines lines({reinterpret_cast<const char*>(file.data()), file.size()});
  Contents contents;
  contents.format = "TRC";
  contents.table = true;
  lines.next();
  const auto keys = lines.next_filled(), values = lines.next_filled(), names = lines.next_filled(),
             axes = lines.next_filled();
  if (!axes) return bad_data("a TRC file has five lines of header, and this ends before", std::string(kWriteAgain));
  const TrcHeader header(keys->text, values->text);
  const auto rate = positive_number(header["datarate"]);
  std::vector<std::string> markers;
  const char separator = separator_of(names->text);
  auto heads = cells_of(names->text, separator);
  if (heads.size() < 3) heads = words(names->text);  // where an editor put blanks for the tabs
  for (std::size_t k = 2; k < heads.size(); ++k) {
    if (const auto name = mbk::trimmed(heads[k], " \t"); !name.empty()) markers.push_back(printable(std::string(name)));
  }
  const auto first = in_lower_case(heads.front());
  if (heads.size() < 2 || !first.starts_with("frame") || in_lower_case(heads[1]) != "time") {
    return bad_data("the line of names does not begin with Frame# and Time", std::string(kWriteAgain),
                    line_place(names->number));
  }
  const std::size_t columns = 2 + 3 * markers.size();
  if (markers.empty() || columns > kMaxColumns) {
    return bad_data(fmt::format("it names {} markers", markers.size()), std::string(kWriteAgain),
                    line_place(names->number));
  }
  if (auto ok = check_axes(*axes, separator, markers, contents); !ok) return tl::unexpected(ok.error());
  Rows rows(columns);
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    auto cells = cells_of(line->text, separator);
    while (cells.size() > columns && is_blank(cells.back())) cells.pop_back();
    if (cells.size() > columns) {
      return bad_data(
          fmt::format("{} cells where frame, time and {} markers have {}", cells.size(), markers.size(), columns),
          std::string(kWriteAgain), line_place(line->number));
    }
    if (!line->terminated && cells.size() < columns) {
      contents.notes.push_back(
          fmt::format("line {} is incomplete (the recording was cut off there) and was ignored", line->number));
      break;
    }
    if (auto ok = rows.add(*line, cells); !ok) return tl::unexpected(ok.error());
  }
  if (rows.count() == 0) return bad_data("no frame stands behind the header", "nothing was recorded");
  compare_counts(positive_number(header["numframes"]), rows.count(), "frames", contents);
  // No row has more cells than the names need, so that these are right.
  if (const auto count = positive_number(header["nummarkers"]);
      count && *count != static_cast<double>(markers.size())) {
    contents.notes.push_back(
        fmt::format("the header says {} markers, and names {}, which were read", *count, markers.size()));
  }
  const auto add = [&](std::string name, std::string unit, std::size_t c) {
    Array& array = contents.arrays.emplace_back();
    array.name = std::move(name);
    array.unit = std::move(unit);
    array.rate_hz = rate.value_or(0.0);
    rows.give(c, array);
  };
  add("Frame#", "", 0);
  add("Time", "s", 1);
  const std::string unit = printable(std::string(header["units"]));
  if (unit.empty()) contents.notes.emplace_back("the header does not say the unit of the markers");
  std::map<std::string, int> copies;
  for (std::size_t m = 0; m < markers.size(); ++m) {
    const int copy = ++copies[markers[m]];
    if (copy > 1) markers[m] += fmt::format("#{}", copy);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      add(fmt::format("{}.{}", markers[m], std::array{'x', 'y', 'z'}[axis]), unit, 2 + 3 * m + axis);
    }
  }
  note_vectors(contents);
  return contents;
}

}  // namespace mbk::recording
