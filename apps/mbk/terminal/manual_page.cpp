#include "apps/mbk/terminal/manual_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "apps/mbk/options/output.h"
#include "mbk/base/core/trimmed.h"

namespace mbk::app {
namespace {

/// Text as roff prints it, character by character; a line never begins a request.
std::string roff(const std::string& text) {
  constexpr std::string_view kPlain = "\\-'^~`";
  constexpr std::array kEscaped = {"\\e", "\\-", "\\(aq", "\\(ha", "\\(ti", "\\(ga"};
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t which = kPlain.find(text[i]);
    if ((i == 0 || text[i - 1] == '\n') && (text[i] == '.' || text[i] == '\'')) out += "\\&";
    out += which == std::string_view::npos ? std::string(1, text[i]) : kEscaped[which];
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

std::string upper_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
  return text;
}

std::string entry(const std::string& name, const std::string& description) {
  return ".TP\n" + name + "\n" + roff(description) + "\n";
}

std::string entry_of(const OptionText& option) {
  std::string name;
  for (const std::string& one : option.names) name += (name.empty() ? "" : ", ") + bold(one);
  if (!option.value.empty()) name += (name.empty() ? "" : " ") + roff(option.value);
  return entry(name + (option.repeats ? "..." : ""), option.description + option.conditions);
}

/// The text of --help before and after the options: paragraphs, sections that are copied as they are ("Examples:" and
/// the lines below it), and exit codes.
struct Prose {
  std::vector<std::string> paragraphs;
  std::string sections, exit_codes = kExitCodes;

  explicit Prose(const std::string& text) {
    constexpr std::string_view kExitCodesHeading = "Exit codes:";
    std::istringstream lines(text);
    bool in_section = false, in_paragraph = false;
    for (std::string line; std::getline(lines, line);) {
      const bool indented = line.starts_with(' ');
      if (in_section && !indented) sections += ".EE\n";
      in_section = in_section && indented;
      if (in_section) {
        sections += roff(line) + "\n";
      } else if (!indented && line.ends_with(':')) {
        const std::string heading = line.substr(0, line.size() - 1);
        sections += ".SH " + roff(upper_case(heading == "Example" ? "Examples" : heading)) + "\n.EX\n";
        in_section = true;
      } else if (trimmed(line).empty()) {
        in_paragraph = false;
      } else {
        if (!in_paragraph) paragraphs.emplace_back();
        paragraphs.back() += (in_paragraph ? " " : "") + std::string(trimmed(line));
        in_paragraph = true;
      }
    }
    if (in_section) sections += ".EE\n";
    std::erase_if(paragraphs, [&](const std::string& one) {
      if (!one.starts_with(kExitCodesHeading)) return false;
      exit_codes = trimmed(std::string_view(one).substr(kExitCodesHeading.size()));
      return true;
    });
  }
};

std::string synopsis(const CommandText& command) {
  std::string text = bold(command.joined(" "));
  if (!command.options.empty()) text += " [OPTIONS]";
  if (!command.commands.empty()) text += " COMMAND";
  for (const OptionText& one : command.positionals) {
    const std::string name = roff(one.value) + (one.repeats ? "..." : "");
    text += one.required ? " " + name : " [" + name + "]";
  }
  return text + "\n";
}

/// Groups in the order in which --help shows them.
std::string options_of(const CommandText& command) {
  std::vector<std::string> groups = {"Options"};
  for (const OptionText& option : command.options) {
    if (std::ranges::find(groups, option.group) == groups.end()) groups.push_back(option.group);
  }
  std::string text = command.positionals.empty() ? "" : ".SH ARGUMENTS\n";
  for (const OptionText& one : command.positionals) text += entry_of(one);
  text += ".SH OPTIONS\n";
  for (const std::string& group : groups) {
    if (group != groups.front()) text += ".SS " + roff(group) + "\n";
    for (const OptionText& option : command.options) {
      if (option.group == group) text += entry_of(option);
    }
  }
  return text;
}

}  // namespace

std::string manual_file(const CommandText& command) {
  return command.joined("-") + ".1";
}

std::string manual_page(const CommandText& command, const CommandText& root, const std::string& version) {
  const Prose prose(command.description + "\n\n" + command.footer);
  const std::string name = command.joined("-"), &first = prose.paragraphs.front();
  const std::string summary =
      &command == &root ? first.substr(name.size() + 1, first.find(':') - name.size() - 1) : first;
  // No date: a page belongs to a version, and the same version gives the same bytes.
  std::string page =
      fmt::format(".TH {} 1 \"\" \"mbk {}\" \"mbk manual\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}.SH DESCRIPTION\n",
                  roff(upper_case(name)), version, roff(name), roff(summary), synopsis(command));
  for (const std::string& one : prose.paragraphs) page += (&one == &first ? "" : ".PP\n") + roff(one) + "\n";
  if (!command.commands.empty()) page += ".SH COMMANDS\n";
  for (const CommandText& below : command.commands) {
    page += entry(bold(below.joined("-")) + "(1)", below.description);
  }
  page += options_of(command) + prose.sections + ".SH EXIT STATUS\n" + roff(prose.exit_codes) + "\n.SH SEE ALSO\n";
  std::vector<std::string> others;
  if (&command != &root) others.push_back(bold(root.name()) + "(1)");
  for (const CommandText& below : command.commands) others.push_back(bold(below.joined("-")) + "(1)");
  return page + fmt::format("{}\n", fmt::join(others, ",\n"));
}

}  // namespace mbk::app
