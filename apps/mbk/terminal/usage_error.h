#pragma once

#include <string>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// What is wrong with the words of a command line, with what was probably meant, in one sentence without a stop.
[[nodiscard]] std::string usage_message(Command app, const CLI::ParseError& error);

/// The command that was typed, with its parts: "mbk study add"; "mbk" where none was.
[[nodiscard]] std::string typed_command(Command app);

}  // namespace mbk::app
