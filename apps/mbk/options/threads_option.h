#pragma once

#include <string>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// Adds --threads, 0 where it is not given: as many as there are cores.   @param what  "files measured"
Option add_threads_option(Command command, unsigned& threads, const std::string& what);

}  // namespace mbk::app
