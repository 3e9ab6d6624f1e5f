#include "apps/mbk/terminal/command_tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <regex>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"

namespace mbk::app {
namespace {

/// "HZ|none" → none: words in small letters are typed as they are.
std::vector<std::string> words_of(const std::string& placeholder) {
  static const std::regex kWords("[^|]+");
  static const std::regex kWord("[a-z][a-z0-9_-]*");
  std::vector<std::string> words;
  for (std::sregex_iterator at(placeholder.begin(), placeholder.end(), kWords), end; at != end; ++at) {
    if (std::regex_match(at->str(), kWord)) words.push_back(at->str());
  }
  return words;
}

/// ".mat (v4 to v7.3) or .csv" → mat, csv
std::vector<std::string> extensions_of(const std::string& description) {
  static const std::regex kExtension(R"((?:^|[\s(,])\.([a-z][a-z0-9]*))");
  std::vector<std::string> extensions;
  for (std::sregex_iterator at(description.begin(), description.end(), kExtension), end; at != end; ++at) {
    const std::string extension = (*at)[1];
    if (std::ranges::find(extensions, extension) == extensions.end()) extensions.push_back(extension);
  }
  return extensions;
}

Values values_of(CLI::Option& option, const std::string& placeholder, const std::string& description) {
  static const std::regex kWithExtension(R"([A-Z_]+\.([a-z][a-z0-9]*))");
  Values values{.words = words_of(placeholder), .extensions = {}};
  for (const std::string& word : Option(option).words()) {
    if (std::ranges::find(values.words, word) == values.words.end()) values.words.push_back(word);
  }
  if (std::smatch match; std::regex_match(placeholder, match, kWithExtension)) values.extensions = {match[1]};
  const bool positional = option.get_positional();
  if (positional && values.extensions.empty()) values.extensions = extensions_of(description);
  values.folders = placeholder == "FOLDER";
  values.files =
      !values.folders && (placeholder == "FILE" || !values.extensions.empty() || (positional && values.words.empty()));
  return values;
}

std::vector<std::string> names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(option->get_name());
  std::ranges::sort(names);
  return names;
}

OptionText describe_option(CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  text.description = option.get_description();
  text.group = option.get_group();
  text.required = option.get_required();
  if (option.get_items_expected_max() > 0) {
    text.value = option.get_positional() ? option.get_name(true, false) : option.get_type_name();
    text.values = values_of(option, text.value, text.description);
    text.repeats = option.get_expected_max() > 1 || option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  }
  text.needs = names_of(option.get_needs());
  text.excludes = names_of(option.get_excludes());
  text.conditions = conditions_of(option);
  return text;
}

/// The commands that --help lists; former names are not listed.
std::vector<CLI::App*> listed_commands(CLI::App& app) {
  return app.get_subcommands([](CLI::App* one) { return !one->get_group().empty(); });
}

void add_names_below(CLI::App& app, std::vector<std::string>& names) {
  for (CLI::App* below : listed_commands(app)) {
    names.push_back(below->get_name());
    add_names_below(*below, names);
  }
}

CommandText describe_command(CLI::App& app, std::vector<std::string> path) {
  CommandText text;
  path.push_back(app.get_name());
  text.path = path;
  text.description = app.get_description();
  text.footer = app.get_footer();
  for (CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // not listed by --help either
    (option->get_positional() ? text.positionals : text.options).push_back(describe_option(*option));
  }
  for (CLI::App* below : listed_commands(app)) {
    text.commands.push_back(describe_command(*below, path));
  }
  return text;
}

}  // namespace

std::string conditions_of(const CLI::Option& option) {
  std::string text;
  if (!option.get_needs().empty()) text += fmt::format("; only with {}", fmt::join(names_of(option.get_needs()), ", "));
  const std::vector<std::string> excludes = names_of(option.get_excludes());
  if (!excludes.empty()) text += fmt::format("; not with {}", fmt::join(excludes, ", "));
  return text;
}

int run_chosen(Command parent, const Actions& actions) {
  for (const auto& [name, action] : actions) {
    if (parent.has_typed(name)) return action();
  }
  return kWrongUsage;
}

std::string CommandText::joined(const char* separator) const {
  return fmt::format("{}", fmt::join(path, separator));
}

std::vector<std::string> names_below(Command app) {
  std::vector<std::string> names;
  add_names_below(app.cli(), names);
  return names;
}

CommandText describe(Command app) {
  return describe_command(app.cli(), {});
}

}  // namespace mbk::app
