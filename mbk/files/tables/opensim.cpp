#include "mbk/files/tables/opensim.h"

#include <fmt/format.h>

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

/// Rows of numbers, each as long as there are columns.
class Rows {
 public:
  explicit Rows(std::size_t columns) : numbers_(columns) {}

  Result<void> add(const TextLine& line, const std::vector<std::string_view>& cells) {
    for (std::size_t c = 0; c < numbers_.size(); ++c) {
      const auto value = c < cells.size() ? cell_number(cells[c]) : kMissing;
      if (!value) {
        return bad_data(fmt::format("'{}' is not a number", printable(std::string(cells[c].substr(0, 40)))),
                        "write it again with the program that made it",
                        fmt::format("line {}, column {}", line.number, c + 1));
      }
      numbers_[c].push_back(*value);
    }
    return {};
  }

  [[nodiscard]] std::size_t count() const { return numbers_.front().size(); }
  [[nodiscard]] SharedMatrix column(std::size_t c) {
    Vector values = Eigen::Map<const Vector>(numbers_[c].data(), static_cast<Index>(numbers_[c].size()));
    numbers_[c] = {};
    return SharedMatrix::of_column(std::move(values));
  }

 private:
  std::vector<std::vector<double>> numbers_;
};

/// "it says 100 rows and holds 98".
void compare_counts(const std::optional<double>& said, std::size_t there, std::string_view what, Contents& contents) {
  if (!said || *said == static_cast<double>(there)) return;
  contents.notes.push_back(fmt::format("the header says {} {}, and there are {}{}", *said, what, there,
                                       *said > static_cast<double>(there) ? ": the file may have been cut off" : ""));
}

std::vector<std::string_view> cells_of(std::string_view line) {
  return line.find('\t') != line.npos ? split(line, '\t') : words(line);
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
  for (const std::string_view cell : cells_of(labels_line->text))
    labels.push_back(printable(std::string(mbk::trimmed(cell, " \t"))));
  while (!labels.empty() && labels.back().empty()) labels.pop_back();
  if (labels.empty() || labels.size() > kMaxColumns || general_number(labels.front())) {
    return bad_data("the line behind 'endheader' holds no labels", "write it again with the program that made it",
                    line_place(labels_line->number));
  }
  Rows rows(labels.size());
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    auto cells = cells_of(line->text);
    while (cells.size() > labels.size() && mbk::trimmed(cells.back(), " \t").empty()) cells.pop_back();
    if (is_cut(*line, cells.size(), labels.size())) {
      contents.notes.push_back(
          fmt::format("line {} is incomplete (the recording was cut off there) and was ignored", line->number));
      break;
    }
    if (cells.size() != labels.size()) {
      return bad_data(fmt::format("{} numbers where there are {} labels", cells.size(), labels.size()),
                      "write it again with the program that made it", line_place(line->number));
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
  if (const auto entry = header.find("indegrees"); entry != header.end() && entry->second == "yes") {
    contents.units = {"deg"};
  }
  for (std::size_t c = 0; c < labels.size(); ++c) {
    Array& array = contents.arrays.emplace_back();
    array.name = std::move(labels[c]);
    array.values = rows.column(c);
  }
  return contents;
}

bool looks_like_trc(std::string_view text) {
  return text.starts_with("PathFileType") || text.starts_with("\xEF\xBB\xBFPathFileType");
}

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
  const auto said = [&](std::string_view key) -> std::string {
    const auto all = words(keys->text), their = words(values->text);
    for (std::size_t k = 0; k < std::min(all.size(), their.size()); ++k) {
      if (in_lower_case(all[k]) == key) return std::string(their[k]);
    }
    return "";
  };
  const auto rate = positive_number(said("datarate"));
  std::vector<std::string> markers;
  const auto heads = split(names->text, '\t');
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
  if (const auto count = positive_number(said("nummarkers")); count && *count != static_cast<double>(markers.size())) {
    return bad_data(fmt::format("the header says {} markers, and names {}", *count, markers.size()),
                    std::string(kWriteAgain), line_place(names->number));
  }
  Rows rows(columns);
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    auto cells = line->text.find('\t') != line->text.npos ? split(line->text, '\t') : words(line->text);
    while (cells.size() > columns && mbk::trimmed(cells.back(), " \t").empty()) cells.pop_back();
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
  compare_counts(positive_number(said("numframes")), rows.count(), "frames", contents);
  const auto add = [&](std::string name, std::string unit, std::size_t c) {
    Array& array = contents.arrays.emplace_back();
    array.name = std::move(name);
    array.unit = std::move(unit);
    array.rate_hz = rate.value_or(0.0);
    array.values = rows.column(c);
  };
  add("Frame#", "", 0);
  add("Time", "s", 1);
  const std::string unit = printable(said("units"));
  std::map<std::string, int> copies;
  for (std::size_t m = 0; m < markers.size(); ++m) {
    const int copy = ++copies[markers[m]];
    if (copy > 1) markers[m] += fmt::format("#{}", copy);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      add(fmt::format("{}.{}", markers[m], std::array{'x', 'y', 'z'}[axis]), unit, 2 + 3 * m + axis);
    }
  }
  return contents;
}

}  // namespace mbk::recording
