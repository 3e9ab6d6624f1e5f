#pragma once

#include <string>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// The error of a command line in one sentence without a full stop, with a suggestion.
[[nodiscard]] std::string usage_message(Command app, const CLI::ParseError& error);

/// The typed command with its parents: "mbk study add"; "mbk" if there is none.
[[nodiscard]] std::string typed_command(Command app);

}  // namespace mbk::app
