#pragma once

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// --help and --help-all, as wide as the terminal, here and in commands that are added from then on. --help fits a
/// screen: where a command has more to say, it shows the options that stand in no section with a line each, names the
/// sections, and gives the first examples.
void add_help(Command app);

}  // namespace mbk::app
