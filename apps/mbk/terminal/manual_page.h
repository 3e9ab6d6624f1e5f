#pragma once

#include <string>

#include "apps/mbk/terminal/command_tree.h"

namespace mbk::app {

/// The manual page of one command in roff (macros of man(7)): its name, synopsis, description, arguments, options by
/// their groups, examples, exit status, and the related pages. Its text is that of --help.
[[nodiscard]] std::string manual_page(const CommandText& command, const CommandText& root, const std::string& version);

/// "mbk-springs-field.1"
[[nodiscard]] std::string manual_file(const CommandText& command);

}  // namespace mbk::app
