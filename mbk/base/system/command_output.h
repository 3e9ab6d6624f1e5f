#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::system {

struct CommandOutput {
  int code = 0;  ///< exit code; 128 and the signal's number where one ended it
  std::string out, error;
};

/// Runs a command to its end, at most so long [s], without input.
/// @param command  the program, looked for in PATH, and its arguments
/// @fails  usage: there is no such program. data: it did not end in time, or says more than 256 MB.
[[nodiscard]] Result<CommandOutput> command_output(const std::vector<std::string>& command, double longest_s);

}  // namespace mbk::system
