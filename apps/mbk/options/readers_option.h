#pragma once

#include <optional>

#include "apps/mbk/terminal/command.h"
#include "mbk/model/trial/readers.h"

namespace mbk::app {

/// Adds --readable-by owner|group|all, of a recording that a command writes.
void add_readers_option(Command command, std::optional<Readers>& readers);

}  // namespace mbk::app
