#pragma once

#include <string>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// Adds --threads, 0 if it is not given: the number of cores.   @param what  "number of files measured in parallel"
Option add_threads_option(Command command, unsigned& threads, const std::string& what);

}  // namespace mbk::app
