#pragma once

#include <string>
#include <string_view>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// Adds every command to `app`, in the order of --help, and returns their actions. Adding the options of all commands
/// takes half of the start-up time: if `first` names a command, only that one is added, unless it needs all of them;
/// for "--version" and "--cite", none.
/// @param first  the first word on the command line    @param typed  all of it, which a report repeats
[[nodiscard]] Actions add_commands(std::string_view first, Command app, const std::string& typed);

}  // namespace mbk::app
