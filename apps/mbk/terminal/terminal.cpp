#include "apps/mbk/terminal/terminal.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <vector>

#include "apps/mbk/terminal/folded_table.h"
#include "mbk/base/core/printable.h"
#include "mbk/base/system/terminal.h"
#include "mbk/present/report/picture.h"
#include "mbk/present/report/text.h"

namespace mbk::app {
namespace terminal {

constexpr std::size_t kNarrowest = 60;
constexpr const char *kBold = "\x1b[1m", *kRed = "\x1b[1;31m", *kYellow = "\x1b[33m", *kCyan = "\x1b[36m",
                     *kPlain = "\x1b[0m";

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::size_t indent_of(std::string_view line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

/// Where the text of a line begins: after its first column if it has one, as in "  window    12 s to 62 s".
std::size_t text_begin(std::string_view line, std::size_t columns) {
  const std::size_t indent = indent_of(line), gap = line.find("  ", indent);
  if (gap == std::string_view::npos || 2 * gap > columns) return indent;
  const std::size_t begin = std::min(line.find_first_not_of(' ', gap), line.size());
  return 2 * begin > columns ? indent : begin;
}

/// Whether a line continues the previous one, of which `rest` did not fit: it has the same indentation, and the
/// previous line neither ended a sentence nor had room for its first word.
bool continues(std::string_view rest, std::size_t hanging, std::string_view previous, std::string_view line) {
  constexpr std::string_view kEnds = ".:)";
  const std::string_view word = line.substr(indent_of(line), line.find(' ', indent_of(line)) - indent_of(line));
  return report::columns(previous) + 1 + report::columns(word) > report::kLineColumns && !rest.empty() &&
         kEnds.find(rest.back()) == std::string_view::npos && indent_of(line) == hanging && hanging < line.size() &&
         line.find("  ", hanging) == std::string_view::npos && !line.ends_with(':');
}

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(words, [&](std::string_view word) { return text.starts_with(word); });
}

std::string in_colour(std::string_view text, const char* colour) {
  return colour + std::string(text) + kPlain;
}

/// Colours the names of an option, which end at two blanks or at the end of the line.
std::string with_option(std::string_view line) {
  const std::size_t begin = indent_of(line), end = std::min(line.find("  ", begin), line.size());
  return std::string(line.substr(0, begin)) + in_colour(line.substr(begin, end - begin), kCyan) +
         std::string(line.substr(end));
}

std::string coloured_line(std::string_view line) {
  const std::string_view said = line.substr(indent_of(line));
  if (!line.starts_with(' ') && line.size() > 1 && line.ends_with(':')) return in_colour(line, kBold);
  if (line.starts_with("Usage:")) return in_colour("Usage:", kBold) + std::string(line.substr(6));
  if (starts_with_any(line, {"  -", "      --"})) return with_option(line);
  if (starts_with_any(said, {"NOT USABLE", "NOT absolutely stable"})) return in_colour(line, kRed);
  if (said.starts_with("! ")) return in_colour(line, kYellow);
  return std::string(line);
}

}  // namespace terminal

bool is_drawing(std::string_view line) {
  return line.find("\xE2\xA0") != std::string_view::npos || line.find("\xE2\xA1") != std::string_view::npos ||
         line.find("\xE2\xA2") != std::string_view::npos || line.find("\xE2\xA3") != std::string_view::npos ||
         line.find("\xE2\x94") != std::string_view::npos || line.find("\xE2\x96") != std::string_view::npos;
}

Terminal terminal_at(int descriptor) {
  Terminal found;
  if (!system::is_terminal(descriptor)) return found;
  found.there = true;
  const char* const no_colour = std::getenv("NO_COLOR");
  found.colour = (no_colour == nullptr || *no_colour == '\0') && system::shows_colours(descriptor);
  if (const std::size_t columns = system::terminal_columns(descriptor); columns > 0) {
    found.columns = std::clamp(columns, terminal::kNarrowest, report::kLineColumns);
  }
  return found;
}

std::string fitted(std::string_view text, std::size_t columns) {
  using namespace terminal;
  std::string out, rest;  // of a line that was broken
  std::size_t hanging = 0;
  const auto put = [&](std::string line) {
    while (line.ends_with(' ')) line.pop_back();
    out += line + "\n";
  };
  const auto finish = [&] {
    if (!rest.empty()) put(std::string(hanging, ' ') + rest);
    rest.clear();
  };
  const std::vector<std::string_view> lines = lines_of(text);
  std::size_t fit = 0;  // end of a table that fits: its lines are not examined again
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const FoldedTable table = k < fit ? FoldedTable{} : folded_table(std::span(lines).subspan(k), columns);
    if (!table.text.empty()) {
      finish();
      out += table.text;
      k += table.lines - 1;
      continue;
    }
    fit = std::max(fit, k + table.lines);
    const std::string_view given = lines[k];
    std::string line(given);
    if (continues(rest, hanging, k > 0 ? lines[k - 1] : "", given)) {
      line = std::string(hanging, ' ') + rest + " " + std::string(given.substr(hanging));
      rest.clear();
    } else {
      finish();
      hanging = 0;
    }
    const std::size_t begin = hanging > 0 ? hanging : text_begin(line, columns);
    if (report::columns(line) <= columns || is_drawing(line) || line.find(' ', begin) == std::string::npos) {
      put(line);
      continue;
    }
    constexpr std::size_t kDeeper = 4;
    hanging = report::columns(std::string_view(line).substr(0, begin)) + (line.starts_with("  mbk ") ? kDeeper : 0);
    std::string broken = report::wrapped(std::string_view(line).substr(begin), columns - hanging);
    std::string before = line.substr(0, begin);
    for (std::size_t end = broken.find('\n'); end != std::string::npos; end = broken.find('\n')) {
      put(before + broken.substr(0, end));
      broken.erase(0, end + 1);
      before = std::string(hanging, ' ');
    }
    rest = broken;
  }
  finish();
  return out;
}

std::string coloured(std::string_view text) {
  std::string out;
  for (const std::string_view line : terminal::lines_of(text)) out += terminal::coloured_line(line) + "\n";
  return out;
}

std::string for_people(const std::string& given, const Terminal& terminal) {
  const std::string text = printable_lines(given);
  if (!terminal.there) return text;
  const std::string lines = terminal.columns < report::kLineColumns ? fitted(text, terminal.columns) : text;
  return terminal.colour ? coloured(lines) : lines;
}

}  // namespace mbk::app
