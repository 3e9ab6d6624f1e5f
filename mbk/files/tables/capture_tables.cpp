#include "mbk/files/tables/capture_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/trimmed.h"
#include "mbk/files/contents/cells.h"
#include "mbk/files/tables/text_rows.h"

namespace mbk::recording {
namespace capture {

/// Whether it is one word or name, and nothing behind it.
bool is_one_cell(const std::vector<std::string>& labels) {
  return !labels.front().empty() &&
         std::all_of(labels.begin() + 1, labels.end(), [](const std::string& label) { return label.empty(); });
}

std::string axis_of(const std::string& label) {
  return label.size() <= 3 && label.find_first_not_of("XYZW'") == label.npos ? in_lower_case(label) : label;
}

// ---- Vicon ----

bool begins_frames(const std::vector<std::string>& labels) {
  return labels.size() > 2 && in_lower_case(labels[0]) == "frame" && in_lower_case(labels[1]) == "sub frame";
}

/// A section of a Vicon file.
struct Section {
  std::string name;
  double rate_hz = 0.0;
  std::vector<std::string> names, units;  ///< of its columns, frame and sub frame first
  double first_frame = 0.0;
};

class ViconDecoder {
 public:
  explicit ViconDecoder(std::span<const std::byte> file) : lines_(text_of(file)), bytes_(file.size()) {}

  Result<Contents> run() {
    contents_.format = "Vicon CSV";
    contents_.table = true;
    for (auto line = lines_.next(); line;) {
      const auto labels = labels_of(line->text, separator_of(line->text));
      if (!begins_frames(labels)) {
        if (!is_empty_row(line->text)) above_.push_back(labels);
        line = lines_.next();
        continue;
      }
      line = MBK_TRY(section(*line));
    }
    leave_out(above_.size());
    if (!left_out_.empty()) {
      contents_.notes.push_back(fmt::format("sections without frames were omitted: {}", fmt::join(left_out_, ", ")));
    }
    if (contents_.arrays.empty()) return bad_data("the file contains no frames", "nothing was recorded, or exported");
    return std::move(contents_);
  }

 private:
  /// From its row of axes on.
  /// @returns  the first line behind it
  Result<std::optional<TextLine>> section(const TextLine& axes) {
    const char separator = separator_of(axes.text);
    Section section;
    const bool named = above_.size() > 1 && above_.back().front().empty();
    const std::size_t header = std::min<std::size_t>(above_.size(), named ? 3 : 2);
    const std::vector<std::string> groups = named ? above_.back() : std::vector<std::string>();
    const std::size_t rate_row = above_.size() - (named ? 2 : 1);
    if (header > 1) {
      section.rate_hz = positive_number(above_[rate_row].front()).value_or(0.0);
      if (rate_row > 0) section.name = above_[rate_row - 1].front();
    }
    leave_out(above_.size() - header);
    above_.clear();
    if (!(section.rate_hz > 0.0) || section.rate_hz > 1e9) {
      return bad_data("the rate above the names of its section is missing", std::string(kWriteAgain),
                      line_place(axes.number));
    }
    name_columns(labels_of(axes.text, separator), groups, section);
    std::optional<TextLine> line = lines_.next();
    if (line && !is_row(*line, separator)) {
      auto units = labels_of(line->text, separator);
      if (units.size() > 2 && units[0].empty() && units[1].empty()) {
        section.units = std::move(units);
        line = lines_.next();
      }
    }
    return rows(std::move(section), separator, line);
  }

  static bool is_row(const TextLine& line, char separator) {
    const std::string_view frame = line.text.substr(0, line.text.find(separator));
    return !is_blank(frame) && cell_number(mbk::trimmed(frame, " \t\""));
  }

  /// A name is above the first of its columns.
  static void name_columns(const std::vector<std::string>& axes, const std::vector<std::string>& groups,
                           Section& section) {
    std::string group;
    for (std::size_t c = 0; c < std::min(axes.size(), kMaxTextColumns); ++c) {
      if (c < groups.size() && !groups[c].empty()) group = groups[c];
      const std::string axis = axis_of(axes[c]);
      section.names.push_back(c < 2 || axis.empty() ? std::string() : group.empty() ? axis : group + "." + axis);
    }
    while (section.names.size() > 2 && section.names.back().empty()) section.names.pop_back();
  }

  Result<std::optional<TextLine>> rows(Section section, char separator, std::optional<TextLine> line) {
    TextRows rows(section.names.size(), bytes_);
    Steps steps;
    for (; line && is_row(*line, separator); line = lines_.next()) {
      if (is_cut(*line, split(line->text, separator).size(), section.names.size())) {
        contents_.notes.push_back(note_of_cut(*line));
        line.reset();
        break;
      }
      MBK_TRY(add_row(rows, *line, separator, section.names.size()));
      MBK_TRY(steps.add(rows, *line));
    }
    if (line && !is_empty_row(line->text) && !begins_frames(labels_of(line->text, separator)) && rows.count() == 0) {
      return bad_data("there is no row of numbers below its units", std::string(kWriteAgain), line_place(line->number));
    }
    if (rows.count() == 0) {
      left_out_.push_back(section.name);
      return line;
    }
    section.first_frame = rows.column(0).front();
    if (first_ && first_->first_frame != section.first_frame) {
      return bad_data(fmt::format("'{}' begins at frame {}, but '{}' at frame {}", first_->name, first_->first_frame,
                                  section.name, section.first_frame),
                      "export everything over the same frames");
    }
    if (!first_) first_ = section;
    take(section, rows);
    return line;
  }

  /// Frames that follow each other, each of as many sub frames.
  struct Steps {
    double per_frame = 0.0;  ///< 0: not known yet

    Result<void> add(const TextRows& rows, const TextLine& line) {
      const std::size_t n = rows.count();
      if (n < 2) return {};
      const double frame = rows.column(0)[n - 1], sub = rows.column(1)[n - 1];
      const double frame_before = rows.column(0)[n - 2], sub_before = rows.column(1)[n - 2];
      if (frame == frame_before && sub == sub_before + 1.0) return {};
      const bool whole = per_frame == 0.0 || sub_before + 1.0 == per_frame;
      if (frame == frame_before + 1.0 && sub == 0.0 && whole) {
        per_frame = sub_before + 1.0;
        return {};
      }
      return bad_data(fmt::format("frame {}, {} does not follow frame {}, {}", frame, sub, frame_before, sub_before),
                      "export every frame: times are computed from the rate", line_place(line.number));
    }
  };

  void take(Section& section, TextRows& rows) {
    for (std::size_t c = 2; c < section.names.size(); ++c) {
      if (section.names[c].empty()) continue;
      std::string name = section.names[c];
      if (const int copy = ++copies_[name]; copy > 1) name += fmt::format("#{}", copy);
      rows.give(
          c, add_array(contents_, std::move(name), c < section.units.size() ? section.units[c] : "", section.rate_hz));
    }
  }

  /// Of the lines above, those that belong to no section of frames.
  void leave_out(std::size_t lines) {
    for (std::size_t k = 0; k < lines; ++k) {
      const bool name = is_one_cell(above_[k]) && !cell_number(above_[k].front());
      if (name && left_out_.size() < 12) left_out_.push_back(above_[k].front());
    }
  }

  TextLines lines_;
  std::size_t bytes_;
  Contents contents_;
  std::vector<std::vector<std::string>> above_;  ///< lines since the last section
  std::vector<std::string> left_out_;
  std::optional<Section> first_;
  std::map<std::string, int> copies_;
};

}  // namespace capture

bool looks_like_vicon(std::string_view text) {
  for (auto at = text.find("Sub Frame"); at != text.npos; at = text.find("Sub Frame", at + 1)) {
    const auto before = text.substr(0, at).rfind('\n');
    const auto begin = before == text.npos ? 0 : before + 1;
    const auto line = text.substr(begin, std::min(text.find('\n', begin), text.size()) - begin);
    if (capture::begins_frames(labels_of(line, separator_of(line)))) return true;
  }
  return false;
}

Result<Contents> decode_vicon(std::span<const std::byte> file) {
  return capture::ViconDecoder(file).run();
}

bool looks_like_motive(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (text.starts_with('"')) text.remove_prefix(1);
  return text.starts_with("Format Version");
}

Result<Contents> decode_motive(std::span<const std::byte> file) {
  TextLines lines(text_of(file));
  Contents contents;
  contents.format = "Motive CSV";
  contents.table = true;
  const auto first = lines.next_filled();
  const char separator = separator_of(first->text);
  std::map<std::string, std::string> said;
  const auto pairs = labels_of(first->text, separator);
  for (std::size_t k = 0; k + 1 < pairs.size(); k += 2) said[in_lower_case(pairs[k])] = pairs[k + 1];

  std::vector<std::vector<std::string>> header;
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    if (is_empty_row(line->text)) continue;
    header.push_back(labels_of(line->text, separator));
    if (in_lower_case(header.back().front()) == "frame" || header.size() > 16) break;
  }
  if (header.empty() || in_lower_case(header.back().front()) != "frame" || header.back().size() > kMaxTextColumns) {
    return bad_data("the header has no row of axes: Frame, Time (Seconds), X, Y, Z",
                    "export it again from Motive with its header");
  }
  const std::vector<std::string>& axes = header.back();
  const auto row_called = [&](std::string_view name) -> std::optional<std::size_t> {
    for (std::size_t k = 0; k + 1 < header.size(); ++k) {
      if (header[k].size() > 1 && (in_lower_case(header[k][1]) == name || in_lower_case(header[k][0]) == name))
        return k;
    }
    return std::nullopt;
  };
  // Without words in front they are Type, Name, ID, kind.
  const std::size_t name_row = row_called("name").value_or(1);
  if (header.size() < 3 || name_row + 1 >= header.size()) {
    return bad_data("the header has no row of names", "export it again from Motive with its header");
  }
  const std::size_t kind_row = header.size() - 2;
  const bool has_kinds = kind_row > name_row && header[kind_row].size() > 1 && header[kind_row][1].empty();
  const auto cell = [](const std::vector<std::string>& row, std::size_t c) { return c < row.size() ? row[c] : ""; };

  struct Column {
    std::size_t number;
    std::string unit;
  };
  std::vector<Column> used;
  std::vector<std::string> names;
  const bool quaternion = in_lower_case(said["rotation type"]) == "quaternion" || std::ranges::count(axes, "W") > 0;
  for (std::size_t c = 1; c < axes.size(); ++c) {
    const std::string name = cell(header[name_row], c), axis = capture::axis_of(axes[c]);
    if (c == 1 && in_lower_case(axes[c]).starts_with("time")) {
      used.push_back({c, "s"});
      names.push_back(axes[c]);
      continue;
    }
    if (name.empty() && axis.empty()) continue;
    const std::string kind = has_kinds ? cell(header[kind_row], c) : "Position", small = in_lower_case(kind);
    const std::string of_kind = small == "position" ? "" : small == "rotation" ? ".rotation" : "." + kind;
    const bool length = small == "position" || small.find("error") != small.npos;
    const bool degrees = small == "rotation" && !quaternion;
    used.push_back({c, length ? said["length units"] : degrees ? "deg" : ""});
    names.push_back(name + of_kind + (axis.empty() || in_lower_case(axis) == small ? "" : "." + axis));
  }
  number_repeated(names);
  const std::size_t columns = used.empty() ? 1 : used.back().number + 1;
  const double rate = positive_number(said["export frame rate"]).value_or(0.0);
  if (said["length units"].empty()) contents.notes.emplace_back("the header does not state the unit of lengths");

  TextRows rows(columns, file.size());
  for (auto line = lines.next_filled(); line; line = lines.next_filled()) {
    if (is_empty_row(line->text)) continue;
    if (is_cut(*line, split(line->text, separator).size(), columns)) {
      contents.notes.push_back(note_of_cut(*line));
      break;
    }
    MBK_TRY(add_row(rows, *line, separator, columns));
  }
  if (rows.count() == 0) return bad_data("there is no frame after the header", "nothing was recorded");
  compare_counts(positive_number(said["total exported frames"]), rows.count(), "frames", contents);
  for (std::size_t k = 0; k < used.size(); ++k) {
    rows.give(used[k].number, add_array(contents, names[k], used[k].unit, rate < 1e9 ? rate : 0.0));
  }
  return contents;
}

bool looks_like_qualisys(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (!text.starts_with("NO_OF_FRAMES\t") && !text.starts_with("FILE_VERSION\t")) return false;
  return text.find("\nMARKER_NAMES\t") != text.npos || text.find("\nBODY_NAMES\t") != text.npos;
}

Result<Contents> decode_qualisys(std::span<const std::byte> file) {
  TextLines lines(text_of(file));
  Contents contents;
  contents.format = "Qualisys TSV";
  contents.table = true;
  std::map<std::string, std::vector<std::string>> said;
  std::optional<TextLine> line = lines.next_filled();
  const auto is_key = [](std::string_view text) {
    const std::string_view key = text.substr(0, text.find('\t'));
    return key.size() > 3 && key.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") == key.npos &&
           key.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != key.npos;
  };
  for (; line && is_key(line->text); line = lines.next_filled()) {
    auto labels = labels_of(line->text, '\t');
    while (labels.size() > 1 && labels.back().empty()) labels.pop_back();
    std::string key = labels.front();
    labels.erase(labels.begin());
    said[std::move(key)] = std::move(labels);
  }
  const auto value = [&](const char* key) { return said[key].empty() ? std::string() : said[key].front(); };
  std::vector<std::string> markers = said["MARKER_NAMES"];
  if (markers.empty()) {
    return bad_data(fmt::format("the file contains {} data but no markers",
                                value("DATA_INCLUDED").empty() ? "other" : value("DATA_INCLUDED")),
                    "export C3D from QTM, or the 3D data as TSV");
  }
  std::optional<std::size_t> before;  // columns before the first marker: frame and time, or none
  const auto is_number = [](std::string_view text) {
    const auto cell = text.substr(0, text.find('\t'));
    return !is_blank(cell) && (cell_number(cell) || in_lower_case(cell) == "null");
  };
  if (line && !is_number(line->text)) {
    const auto heads = labels_of(line->text, '\t');
    before =
        in_lower_case(heads.front()) == "frame" ? (heads.size() > 1 && in_lower_case(heads[1]) == "time" ? 2 : 1) : 0;
    line = lines.next_filled();
  }
  if (!line) return bad_data("there is no frame after the header", "nothing was recorded");
  if (!before) {
    const std::size_t cells = filled_cells_of(line->text, '\t').size();
    before = cells >= 3 * markers.size() ? cells - 3 * markers.size() : 0;
  }
  if (*before > 2 || markers.size() > kMaxTextColumns) {
    return bad_data(fmt::format("its rows have {} numbers more than its {} markers need", *before, markers.size()),
                    std::string(kWriteAgain), line_place(line->number));
  }
  const std::size_t columns = *before + 3 * markers.size();
  TextRows rows(columns, file.size());
  for (; line; line = lines.next_filled()) {
    auto cells = split(line->text, '\t');
    for (std::string_view& one : cells) {
      if (in_lower_case(one) == "null") one = {};
    }
    while (cells.size() > columns && is_blank(cells.back())) cells.pop_back();
    if (is_cut(*line, cells.size(), columns)) {
      contents.notes.push_back(note_of_cut(*line));
      break;
    }
    if (cells.size() > columns) {
      return bad_data(
          fmt::format("the row has {} cells, but its {} markers need {}", cells.size(), markers.size(), columns),
          std::string(kWriteAgain), line_place(line->number));
    }
    MBK_TRY(rows.add(*line, cells, line->text.find(',') != line->text.npos));
  }
  compare_counts(positive_number(value("NO_OF_FRAMES")), rows.count(), "frames", contents);
  const double rate = positive_number(value("FREQUENCY")).value_or(0.0);
  if (*before == 2) rows.give(1, add_array(contents, "Time", "s", rate < 1e9 ? rate : 0.0));
  number_repeated(markers);
  std::size_t missing = 0;
  for (std::size_t m = 0; m < markers.size(); ++m) {
    std::array<Array*, 3> axes{};
    contents.arrays.reserve(contents.arrays.size() + 3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes[axis] = &add_array(contents, fmt::format("{}.{}", markers[m], "xyz"[axis]), "mm", rate < 1e9 ? rate : 0.0);
      rows.give(*before + 3 * m + axis, *axes[axis]);
    }
    for (Index k = 0; k < axes[0]->values.rows(); ++k) {
      if (std::ranges::any_of(axes,
                              [k](const Array* one) { return one->values.rows() <= k || one->values(k, 0) != 0.0; }))
        continue;
      for (Array* one : axes) one->values(k, 0) = std::nan("");
      ++missing;
    }
  }
  contents.notes.emplace_back("its positions are in mm, as QTM exports them");
  if (missing > 0) {
    contents.notes.push_back(fmt::format("{} positions of exactly 0, 0, 0 were read as missing markers", missing));
  }
  return contents;
}

}  // namespace mbk::recording
