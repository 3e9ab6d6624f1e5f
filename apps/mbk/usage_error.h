#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace mbk::app {

/// Names of a command's options as they are typed ("--cutoff", "-o").
[[nodiscard]] std::vector<std::string> option_names(const CLI::App& command);

/// What is wrong with the words of a command line, with what was probably meant, in one sentence without a stop.
[[nodiscard]] std::string usage_message(const CLI::App& app, const CLI::ParseError& error);

/// The command that was typed, with its parts: "mbk study add"; "mbk" where none was.
[[nodiscard]] std::string typed_command(const CLI::App& app);

}  // namespace mbk::app
