#pragma once

#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// What may stand in the place of a value, as far as a shell can know it.
struct Values {
  std::vector<std::string> words;       ///< fixed values, such as "default" and "reference"
  bool files = false, folders = false;  ///< also names of files, or of folders alone
  std::vector<std::string> extensions;  ///< of those files, without the dot; empty: any file
};

/// One option, flag or positional argument of a command, in the words of --help.
struct OptionText {
  std::vector<std::string> names;          ///< "-h", "--help"; none where it is positional
  std::string value;                       ///< placeholder, "HZ" or "default|reference"; empty for a flag
  std::string description, group;          ///< group: the heading in --help that it stands under
  bool required = false, repeats = false;  ///< repeats: takes several values, or may be given several times
  std::vector<std::string> needs, excludes;
  Values values;
};

/// One command with everything below it.
struct CommandText {
  std::vector<std::string> path;  ///< "mbk", "springs", "field"
  std::string description, footer;
  std::vector<OptionText> options, positionals;
  std::vector<CommandText> commands;

  [[nodiscard]] const std::string& name() const { return path.back(); }
  [[nodiscard]] std::string joined(const char* separator) const;
};

/// The name of every command below this one, each before those below it; no help is made for that.
[[nodiscard]] std::vector<std::string> names_below(Command app);

/// Everything that --help says on every level, as values. Fixed values come from a placeholder with words in small
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
