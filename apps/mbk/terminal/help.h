#pragma once

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// --help and --help-all, as wide as the terminal, here and in commands that are added from then on.
void add_help(Command app);

}  // namespace mbk::app
