#include "apps/mbk/terminal/folded_table.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "apps/mbk/terminal/terminal.h"
#include "mbk/present/report/picture.h"
#include "mbk/present/report/text.h"

namespace mbk::app {
namespace folded {

constexpr std::size_t kGap = 2;             // blanks between columns
constexpr std::size_t kMin = 3;             // columns of a table
constexpr std::size_t kShort = 7;           // maximum width of a column that is repeated in each part
constexpr std::size_t kNarrowestText = 20;  // minimum width of text that is broken between words

/// Characters of a line, each as its bytes; every character is assumed to be one column wide.
std::vector<std::string_view> characters_of(std::string_view line) {
  std::vector<std::string_view> characters;
  for (std::size_t begin = 0; begin < line.size();) {
    std::size_t end = begin + 1;
    while (end < line.size() && (static_cast<unsigned char>(line[end]) & 0xC0U) == 0x80U) ++end;
    characters.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return characters;
}

/// [begin, end) in columns of the terminal.
struct Column {
  std::size_t begin = 0, end = 0;
  [[nodiscard]] std::size_t width() const { return end - begin; }
};

/// Marks the columns of the terminal that any line occupies.
void take_places(const std::vector<std::string_view>& line, std::vector<bool>& taken) {
  taken.resize(std::max(taken.size(), line.size()));
  for (std::size_t k = 0; k < line.size(); ++k) taken[k] = taken[k] || line[k] != " ";
}

std::vector<Column> columns_of(const std::vector<bool>& taken) {
  std::vector<Column> columns;
  for (std::size_t k = 0; k < taken.size(); ++k) {
    if (!taken[k]) continue;
    if (columns.empty() || k >= columns.back().end + kGap) columns.push_back({k, k});
    columns.back().end = k + 1;
  }
  return columns;
}

std::string cell_of(const std::vector<std::string_view>& line, const Column& column) {
  std::string cell;
  for (std::size_t k = column.begin; k < std::min(column.end, line.size()); ++k) cell += line[k];
  return cell;
}

std::string trimmed(std::string text) {
  text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

std::string padded(std::string text, std::size_t width) {
  text.append(width - std::min(width, report::columns(text)), ' ');
  return text;
}

bool blank(std::string_view text) {
  return text.find_first_not_of(' ') == std::string_view::npos;
}

/// Lines with their columns.
struct Grid {
  std::vector<std::vector<std::string_view>> lines;
  std::vector<Column> columns;
  std::size_t width = 0;

  [[nodiscard]] bool wider_than(std::size_t terminal) const { return width > terminal; }
};

Grid grid_of(std::span<const std::string_view> lines) {
  Grid grid;
  std::vector<bool> taken;
  for (const std::string_view line : lines) {
    grid.lines.push_back(characters_of(line));
    take_places(grid.lines.back(), taken);
  }
  grid.columns = columns_of(taken);
  grid.width = grid.columns.empty() ? 0 : grid.columns.back().end;
  return grid;
}

/// Number of lines from the first that form one table: until a line closes a gap between columns.
std::size_t lines_of_table(std::span<const std::string_view> lines) {
  std::vector<bool> taken;
  std::size_t count = 0, columns = kMin;
  for (; count < lines.size() && !blank(lines[count]) && !is_drawing(lines[count]); ++count) {
    take_places(characters_of(lines[count]), taken);
    const std::size_t now = columns_of(taken).size();
    if (now < columns) break;
    columns = now;
  }
  return count;
}

/// A caption and the drawings below it, which have no axes.
std::size_t lines_of_drawings(std::span<const std::string_view> lines) {
  const auto is_picture = [](std::string_view line) {
    return is_drawing(line) && line.find("\xE2\x94") == std::string_view::npos;
  };
  if (lines.empty() || blank(lines[0]) || is_drawing(lines[0])) return 0;
  std::size_t count = 1;
  while (count < lines.size() && is_picture(lines[count])) ++count;
  const bool ends = count == lines.size() || !is_drawing(lines[count]);
  return count > 1 && ends ? count : 0;
}

/// Some of the columns beside the first one.
struct Part {
  std::vector<Column> columns;
  std::size_t last_width = 0;  ///< of its last column if that is broken between words
};

/// As many columns as fit, part by part; empty if one cannot fit.
std::vector<Part> parts_of(const std::vector<Column>& columns, std::size_t room) {
  std::vector<Part> parts;
  std::size_t left = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const std::size_t width = columns[k].width();
    const bool last = k + 1 == columns.size();
    if (!parts.empty() && left >= width + kGap) {
      left -= width + kGap;
    } else if (!parts.empty() && last && left >= kNarrowestText + kGap) {
      parts.back().last_width = left - kGap;
    } else {
      parts.push_back({});
      if (width > room && room < kNarrowestText) return {};
      if (width > room) parts.back().last_width = room;
      left = room - std::min(room, width);
    }
    parts.back().columns.push_back(columns[k]);
  }
  return parts;
}

/// One row of a part, on several lines if its last cell is broken.
std::string row_of(const std::string& label, const std::vector<std::string_view>& line, const Part& part,
                   const std::string& units) {
  std::string text = label, more;
  bool any = false;
  for (std::size_t k = 0; k < part.columns.size(); ++k) {
    std::string cell = cell_of(line, part.columns[k]);
    any = any || !blank(cell);
    const bool broken = k + 1 == part.columns.size() && part.last_width > 0;
    const std::size_t begin = report::columns(text);
    if (broken) {
      const std::string words = report::wrapped(trimmed(cell), part.last_width);
      const std::size_t end = std::min(words.find('\n'), words.size());
      cell = words.substr(0, end);
      for (const char c : words.substr(end)) more += c == '\n' ? "\n" + std::string(begin, ' ') : std::string(1, c);
    }
    text += padded(cell, (broken ? part.last_width : part.columns[k].width()) + kGap);
  }
  if (!any) return "";
  text += units;
  text.erase(text.find_last_not_of(' ') + 1);
  while (!more.empty() && (more.back() == ' ' || more.back() == '\n')) more.pop_back();
  return text + more + "\n";
}

std::string folded(const Grid& grid, std::size_t terminal) {
  std::vector<Column> inner, units;
  for (std::size_t k = 1; k < grid.columns.size(); ++k) {
    const Column& column = grid.columns[k];
    const bool unit = column.width() <= kShort && blank(cell_of(grid.lines.front(), column));
    (unit ? units : inner).push_back(column);
  }
  const std::size_t label = grid.columns.front().end + kGap;
  std::size_t taken = label;
  for (const Column& unit : units) taken += unit.width() + kGap;
  const auto parts = parts_of(inner, terminal - std::min(terminal, taken));
  std::string text;
  for (const Part& part : parts) {
    for (const auto& line : grid.lines) {
      std::string end;
      for (const Column& unit : units) end += padded(cell_of(line, unit), unit.width() + kGap);
      text += row_of(padded(cell_of(line, {0, grid.columns.front().end}), label), line, part, end);
    }
  }
  return text;
}

/// Each drawing below its caption, as many beside one another as fit.
std::string folded_drawings(const Grid& grid, std::size_t terminal) {
  std::string text;
  const std::size_t indent = grid.columns.front().begin;
  for (const Part& part : parts_of(grid.columns, terminal - indent)) {
    for (const auto& line : grid.lines) text += row_of(std::string(indent, ' '), line, part, "");
  }
  return text;
}

/// Whether the captions show where each drawing begins.
bool are_drawings(const Grid& grid) {
  constexpr std::size_t kNarrowest = 16;
  return grid.columns.size() > 1 && std::ranges::all_of(grid.columns, [&](const Column& column) {
           return column.width() >= kNarrowest && !cell_of(grid.lines.front(), column).starts_with(' ');
         });
}

}  // namespace folded

FoldedTable folded_table(std::span<const std::string_view> lines, std::size_t columns) {
  using namespace folded;
  if (const std::size_t count = lines_of_drawings(lines); count > 0) {
    const Grid grid = grid_of(lines.first(count));
    if (!grid.wider_than(columns) || !are_drawings(grid)) return {};
    return {count, folded_drawings(grid, columns)};
  }
  const std::size_t count = lines_of_table(lines);
  if (count < 2) return {};
  const Grid grid = grid_of(lines.first(count));
  if (!grid.wider_than(columns)) return {count, ""};
  std::string text = folded::folded(grid, columns);
  return text.empty() ? FoldedTable{} : FoldedTable{count, std::move(text)};
}

}  // namespace mbk::app
