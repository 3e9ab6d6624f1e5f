#pragma once

#include <string>
#include <string_view>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// Adds every command to `app`, in the order in which --help lists them, and gives what they do. The options of all
/// commands are half of what it takes to start: where `first` names a command, only that one is made, unless it is one
/// that speaks of all; for "--version", none.
/// @param first  the first word on the command line    @param typed  all of it, which a report repeats
[[nodiscard]] Actions add_commands(std::string_view first, Command app, const std::string& typed);

}  // namespace mbk::app
