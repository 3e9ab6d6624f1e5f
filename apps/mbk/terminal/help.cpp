#include "apps/mbk/terminal/help.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "apps/mbk/terminal/terminal.h"
#include "mbk/present/report/picture.h"
#include "mbk/present/report/text.h"

namespace mbk::app {
namespace help {

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* command) const override;

 private:
  std::size_t columns_;
};

constexpr std::size_t kNameColumns = 30, kNarrowNameColumns = 24, kNarrow = 80;
constexpr std::ptrdiff_t kScreenLines = 40;

std::size_t name_columns(std::size_t columns) {
  return columns < kNarrow ? kNarrowNameColumns : kNameColumns;
}

std::ptrdiff_t lines_in(std::string_view text) {
  return std::ranges::count(text, '\n');
}

/// As much of a description as one line holds: its first clause, or else the words that fit.
std::string brief(const std::string& text, std::size_t width) {
  if (report::columns(text) <= width) return text;
  for (const char* const end : {"; ", ": ", " ("}) {
    const std::string clause = text.substr(0, text.find(end));
    constexpr std::size_t kSaysEnough = 20;
    if (clause.size() >= kSaysEnough && report::columns(clause) <= width) return clause;
  }
  const std::string lines = report::wrapped(text, width - 2);
  return lines.substr(0, lines.find('\n')) + " …";
}

std::string entry(const std::string& name, const std::string& description, std::size_t columns) {
  const std::size_t names = name_columns(columns);
  std::string line = "  " + name + " ";
  const std::size_t used = report::columns(line);
  if (used < names) line.append(names - used, ' ');
  return line + brief(description, columns - std::min(columns - 20, report::columns(line))) + "\n";
}

std::string name_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true, false);
  const std::string type = option.get_items_expected_max() > 0 ? " " + option.get_type_name() : "";
  return option.get_name(false, true) + type;
}

/// Sections beside the one without a name of its own, as they stand in --help-all.
std::vector<std::string> sections_of(const CLI::App& app) {
  std::vector<std::string> sections;
  for (const std::string& group : app.get_groups()) {
    const bool used = !app.get_options([&](const CLI::Option* option) { return option->get_group() == group; }).empty();
    if (used && !group.empty() && group != "Options") sections.push_back(group);
  }
  return sections;
}

/// Parts of a footer that stand between empty lines.
std::vector<std::string> blocks_of(const std::string& footer) {
  std::vector<std::string> blocks;
  for (std::size_t begin = 0; begin < footer.size();) {
    const std::size_t end = std::min(footer.find("\n\n", begin), footer.size());
    blocks.push_back(footer.substr(begin, end - begin) + "\n");
    begin = footer.find_first_not_of('\n', end);
  }
  return blocks;
}

/// The examples of a block that so many lines hold; nothing where not even the first fits.
std::string examples_within(const std::string& block, std::ptrdiff_t room) {
  std::string taken;
  for (std::size_t begin = 0; begin < block.size();) {
    std::size_t end = block.find('\n', begin) + 1;
    while (end < block.size() && block.compare(end, 3, "   ") == 0) end = block.find('\n', end) + 1;  // what it does
    const std::string more = block.substr(begin, end - begin);
    if (lines_in(taken) + lines_in(more) > room) break;
    taken += more;
    begin = end;
  }
  return lines_in(taken) > 1 ? taken : "";
}

std::string short_footer(const std::string& footer, std::ptrdiff_t room) {
  std::string text;
  for (const std::string& block : blocks_of(footer)) {
    const std::ptrdiff_t left = room - lines_in(text) - 1;
    std::string fits = block;
    if (lines_in(block) > left) fits = block.starts_with("Example") ? examples_within(block, left) : "";
    if (!fits.empty()) text += "\n" + fits;
  }
  return text;
}

HelpFormatter::HelpFormatter() : columns_(terminal_at(STDOUT_FILENO).columns) {
  column_width(name_columns(columns_));
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  return report::wrapped(option->get_description(), columns_ - name_columns(columns_));
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  std::stringstream out;
  const std::size_t names = name_columns(columns_);
  CLI::detail::format_help(out, command->get_display_name(true),
                           report::wrapped(command->get_description(), columns_ - names), names);
  return out.str();
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  std::string whole = fitted(Formatter::make_help(app, name, CLI::AppFormatMode::Normal), columns_);
  if (mode == CLI::AppFormatMode::All || lines_in(whole) <= kScreenLines) return whole;
  std::string text = make_description(app) + make_usage(app, name) + "\n";
  const auto add = [&](const CLI::Option* option) {
    text += entry(name_of(*option), option->get_description(), columns_);
  };
  for (const CLI::Option* option : app->get_options()) {
    if (option->get_positional() && !option->get_group().empty()) add(option);
  }
  const auto commands = app->get_subcommands([](const CLI::App* one) { return !one->get_group().empty(); });
  text += commands.empty() ? "\nOptions:\n" : "Options:";
  for (const CLI::Option* option : app->get_options()) {
    if (!option->nonpositional() || option->get_group() != "Options") continue;
    if (commands.empty()) {
      add(option);
    } else {
      text += " " + option->get_name();
    }
  }
  if (!commands.empty()) text += "\n\nSubcommands:\n";
  for (const CLI::App* one : commands) text += entry(one->get_display_name(true), one->get_description(), columns_);
  const auto sections = sections_of(*app);
  const std::string also = sections.empty() ? "" : fmt::format("Also: {}.\n", fmt::join(sections, ", "));
  const std::string rest = commands.empty() ? fmt::format("\n{}Every option: {} --help-all\n", also, name) : "";
  text = fitted(text, columns_);
  return text + short_footer(fitted(app->get_footer() + "\n", columns_), kScreenLines - lines_in(text + rest)) +
         fitted(rest, columns_);
}

}  // namespace help

void add_help(Command app) {
  app.cli().formatter(std::make_shared<help::HelpFormatter>());
  app.cli().set_help_all_flag("--help-all", "print every option, in sections, with all there is to say");
}

}  // namespace mbk::app
