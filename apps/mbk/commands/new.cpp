#include <fmt/format.h>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/new_commands.h"
#include "mbk/base/core/option_checks.h"

namespace mbk::app {

void add_new_file_options(Command command, NewFileArguments& arguments) {
  command.add_option("--out", arguments.out, fmt::format("file to write (default: {})", arguments.out.string()))
      .type_name("FILE.toml")
      .check(not_empty());
  command.add_flag("--overwrite", arguments.overwrite, "replace an existing file");
  command.add_flag("--yes", arguments.yes, "ask no questions; accept every default");
}

Action add_new(Command app) {
  const Command group =
      app.add_command("new", "write a channel map, an experiment or a robot description, step by step");
  group.require_subcommand();
  group.footer(
      "Examples:\n"
      "  mbk new channels log.csv\n"
      "      guesses which column is which channel, draws the first seconds, and prints the command 'mbk measure'\n"
      "  mbk new experiment --out mine.toml\n"
      "  mbk new robot --out robot.toml\n\n"
      "Each question shows its default in brackets. Enter accepts it, --yes accepts all defaults; answers\n"
      "can also be piped in, one a line.");
  const Actions actions = {{"channels", add_new_channels(group)},
                           {"experiment", add_new_experiment(group)},
                           {"robot", add_new_robot(group)}};
  return [group, actions] { return run_chosen(group, actions); };
}

}  // namespace mbk::app
