#pragma once

#include <filesystem>

#include "apps/mbk/commands.h"

namespace mbk::app {

/// A file that answers are written to.
struct NewFileArguments {
  std::filesystem::path out;
  bool yes = false, overwrite = false;
};

/// --out, whose default stands in `arguments`, --overwrite and --yes.
void add_new_file_options(CLI::App& command, NewFileArguments& arguments);

/// The parts of 'mbk new'. Each adds itself to the group.
Action add_new_channels(CLI::App& group);
Action add_new_experiment(CLI::App& group);
Action add_new_robot(CLI::App& group);

}  // namespace mbk::app
