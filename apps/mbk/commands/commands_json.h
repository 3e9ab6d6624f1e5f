#pragma once

#include <string>

#include "apps/mbk/terminal/command_tree.h"
#include "mbk/base/document/fields.h"

namespace mbk::app {

/// Every command with its arguments and options, as --help describes them: schema mbk.commands/1. The functions in
/// other languages are generated from it, so that an option is defined once.
[[nodiscard]] std::string commands_json(const CommandText& root);

void add_commands_schema(document::Schemas& schemas);

}  // namespace mbk::app
