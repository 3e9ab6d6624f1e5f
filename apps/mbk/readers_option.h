#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "mbk/model/trial/readers.h"

namespace mbk::app {

/// Adds --readable-by owner|group|all, of a recording that a command writes.
void add_readers_option(CLI::App& command, std::optional<Readers>& readers);

}  // namespace mbk::app
