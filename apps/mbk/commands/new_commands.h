#pragma once

#include <filesystem>

#include "apps/mbk/commands/commands.h"

namespace mbk::app {

/// A file that answers are written to.
struct NewFileArguments {
  std::filesystem::path out;
  bool yes = false, overwrite = false;
};

/// --out, whose default is in `arguments`, --overwrite and --yes.
void add_new_file_options(Command command, NewFileArguments& arguments);

/// The parts of 'mbk new'. Each adds itself to the group.
Action add_new_channels(Command group);
Action add_new_experiment(Command group);
Action add_new_robot(Command group);

}  // namespace mbk::app
