#pragma once

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// --help, as wide as the terminal, for `app` and for commands that are added to it later. --help-all prints the same;
/// it is still read, but not listed.
void add_help(Command app);

}  // namespace mbk::app
