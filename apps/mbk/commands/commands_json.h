#pragma once

#include <string>

#include "apps/mbk/terminal/command_tree.h"
#include "mbk/base/document/fields.h"

namespace mbk::app {

/// Every command with its arguments and options, in the words of --help: schema mbk.commands/1. What other languages'
/// functions are made of, so that an option stands in one table.
[[nodiscard]] std::string commands_json(const CommandText& root);

void add_commands_schema(document::Schemas& schemas);

}  // namespace mbk::app
