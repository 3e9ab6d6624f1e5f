#pragma once

#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// The possible values of an option, as far as a shell can know them.
struct Values {
  std::vector<std::string> words;       ///< fixed values, such as "default" and "reference"
  bool files = false, folders = false;  ///< also names of files, or only of folders
  std::vector<std::string> extensions;  ///< of those files, without the dot; empty: any file
};

/// "; only with --report; not with --list": what an option needs and excludes, to follow its description.
[[nodiscard]] std::string conditions_of(const CLI::Option& option);

/// One option, flag or positional argument of a command, as --help describes it.
struct OptionText {
  std::vector<std::string> names;          ///< "-h", "--help"; none for a positional argument
  std::string value;                       ///< placeholder, "HZ" or "default|reference"; empty for a flag
  std::string description, group;          ///< group: its heading in --help
  bool required = false, repeats = false;  ///< repeats: takes several values, or may be given several times
  std::vector<std::string> needs, excludes;
  std::string conditions;  ///< as conditions_of
  Values values;
};

/// One command with its subcommands.
struct CommandText {
  std::vector<std::string> path;  ///< "mbk", "springs", "field"
  std::string description, footer;
  std::vector<OptionText> options, positionals;
  std::vector<CommandText> commands;

  [[nodiscard]] const std::string& name() const { return path.back(); }
  [[nodiscard]] std::string joined(const char* separator) const;
};

/// The name of every command below this one, each before its subcommands; builds no help text.
[[nodiscard]] std::vector<std::string> names_below(Command app);

/// The help of every command as values. Fixed values come from a placeholder with words in small
/// letters between bars ("HZ|none": none), from suggests() and, for files, from extensions: in the placeholder
/// ("REC.mat") or in the description of a positional argument (".mat or .csv").
[[nodiscard]] CommandText describe(Command app);

/// `visit` for this command, then for each below it.
template <class Visit>
void for_each_command(const CommandText& command, const Visit& visit) {
  visit(command);
  for (const CommandText& below : command.commands) for_each_command(below, visit);
}

}  // namespace mbk::app
