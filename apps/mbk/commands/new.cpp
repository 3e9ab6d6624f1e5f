#include <fmt/format.h>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/new_commands.h"
#include "mbk/base/core/option_checks.h"

namespace mbk::app {

void add_new_file_options(Command command, NewFileArguments& arguments) {
  command.add_option("--out", arguments.out, fmt::format("the file to write ({})", arguments.out.string()))
      .type_name("FILE.toml")
      .check(not_empty());
  command.add_flag("--overwrite", arguments.overwrite, "replace that file where it is there");
  command.add_flag("--yes", arguments.yes, "ask nothing: take what is proposed");
}

Action add_new(Command app) {
  const Command group = app.add_command("new", "write the channels of a file, an experiment or a robot, step by step");
  group.require_subcommand();
  group.footer(
      "Examples:\n"
      "  mbk new channels log.csv\n"
      "      which column is what: guesses, shows the first seconds, and prints the option for 'mbk measure'\n"
      "  mbk new experiment --out mine.toml\n"
      "  mbk new robot --out robot.toml\n\n"
      "Each proposes an answer in brackets; Enter takes it, --yes takes them all, a pipe answers line by line.");
  const Actions actions = {{"channels", add_new_channels(group)},
                           {"experiment", add_new_experiment(group)},
                           {"robot", add_new_robot(group)}};
  return [group, actions] { return run_chosen(group, actions); };
}

}  // namespace mbk::app
