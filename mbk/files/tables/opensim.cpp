#include "mbk/files/tables/opensim.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/contents/text_lines.h"
#include "mbk/files/tables/text_rows.h"

namespace mbk::recording {
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
  TextLines lines(text_of(file));
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
  if (!labels_line)
    return bad_data("there are no labels after 'endheader'", "nothing was recorded, or the file is truncated");
  std::vector<std::string> labels;
  const char separator = separator_of(labels_line->text);
  for (const std::string_view cell : filled_cells_of(labels_line->text, separator)) {
    labels.push_back(printable(std::string(mbk::trimmed(cell, " \t"))));
  }
  if (labels.empty() || labels.size() > kMaxTextColumns || general_number(labels.front())) {
    return bad_data("the line after 'endheader' contains no labels", std::string(kWriteAgain),
                    line_place(labels_line->number));
  }
  TextRows rows(labels.size(), file.size());
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    if (is_empty_row(line->text)) continue;
    auto cells = cells_of(line->text, separator);
    while (cells.size() > labels.size() && is_blank(cells.back())) cells.pop_back();
    if (is_cut(*line, cells.size(), labels.size())) {
      contents.notes.push_back(note_of_cut(*line));
      break;
    }
    if (cells.size() != labels.size()) {
      return bad_data(fmt::format("the line has {} numbers, but there are {} labels", cells.size(), labels.size()),
                      std::string(kWriteAgain), line_place(line->number));
    }
    MBK_TRY(rows.add(*line, cells));
  }
  if (rows.count() == 0) return bad_data("there is no line of numbers after the labels", "nothing was recorded");
  const auto said = [&](const char* today, const char* old) -> std::optional<double> {
    for (const char* key : {today, old}) {
      if (const auto entry = header.find(key); entry != header.end()) return positive_number(entry->second);
    }
    return std::nullopt;
  };
  compare_counts(said("nrows", "datarows"), rows.count(), "rows", contents);
  compare_counts(said("ncolumns", "datacolumns"), labels.size(), "columns", contents);
  if (const auto entry = header.find("indegrees"); entry != header.end()) {
    if (entry->second == "yes") contents.units = {"deg"};
  } else if (!header.contains("datatype")) {  // of orientations, which are vectors
    contents.notes.emplace_back(
        "the header does not state inDegrees: angles are read in rad unless --channels gives deg");
  }
  for (std::size_t c = 0; c < labels.size(); ++c) {
    Array& array = contents.arrays.emplace_back();
    array.name = std::move(labels[c]);
    rows.give(c, array);
  }
  note_obstacles("vectors", contents);
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
    return bad_data("there is no line of axes, X1 Y1 Z1, below the names", std::string(kWriteAgain),
                    line_place(line.number));
  }
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const std::string label = in_lower_case(labels[k]);
    if (label.front() != "xyz"[k % 3]) {
      return bad_data(fmt::format("'{}' was found instead of the {} axis of '{}'", printable(std::string(labels[k])),
                                  "XYZ"[k % 3], markers[k / 3]),
                      std::string(kWriteAgain), line_place(line.number));
    }
    const auto number = cell_number(std::string_view(label).substr(1));
    if (k % 3 == 0 && number && *number != static_cast<double>(k / 3 + 1) && label.size() > 1) {
      contents.notes.push_back(fmt::format("the axes of '{}' are called {}; the marker name was used", markers[k / 3],
                                           printable(std::string(labels[k]))));
    }
  }
  return {};
}

}  // namespace

Result<Contents> decode_trc(std::span<const std::byte> file) {
  TextLines lines(text_of(file));
  Contents contents;
  contents.format = "TRC";
  contents.table = true;
  lines.next();
  const auto keys = lines.next_filled(), values = lines.next_filled(), names = lines.next_filled(),
             axes = lines.next_filled();
  if (!axes) return bad_data("the file ends within the five header lines of a TRC file", std::string(kWriteAgain));
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
  if (markers.empty() || columns > kMaxTextColumns) {
    return bad_data(fmt::format("the header names {} markers", markers.size()), std::string(kWriteAgain),
                    line_place(names->number));
  }
  MBK_TRY(check_axes(*axes, separator, markers, contents));
  TextRows rows(columns, file.size());
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    if (is_empty_row(line->text)) continue;
    auto cells = cells_of(line->text, separator);
    while (cells.size() > columns && is_blank(cells.back())) cells.pop_back();
    if (cells.size() > columns) {
      return bad_data(fmt::format("the row has {} cells, but frame, time and {} markers need {}", cells.size(),
                                  markers.size(), columns),
                      std::string(kWriteAgain), line_place(line->number));
    }
    if (is_cut(*line, cells.size(), columns)) {
      contents.notes.push_back(note_of_cut(*line));
      break;
    }
    MBK_TRY(rows.add(*line, cells));
  }
  if (rows.count() == 0) return bad_data("there is no frame after the header", "nothing was recorded");
  compare_counts(positive_number(header["numframes"]), rows.count(), "frames", contents);
  // No row has more cells than the names need, so that these are right.
  if (const auto count = positive_number(header["nummarkers"]);
      count && *count != static_cast<double>(markers.size())) {
    contents.notes.push_back(
        fmt::format("the header states {} markers but names {}, which were read", *count, markers.size()));
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
  if (unit.empty()) contents.notes.emplace_back("the header does not state the unit of the markers");
  number_repeated(markers);
  for (std::size_t m = 0; m < markers.size(); ++m) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      add(fmt::format("{}.{}", markers[m], std::array{'x', 'y', 'z'}[axis]), unit, 2 + 3 * m + axis);
    }
  }
  note_obstacles("vectors", contents);
  return contents;
}

}  // namespace mbk::recording
