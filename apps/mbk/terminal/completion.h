#pragma once

#include <string>

#include "apps/mbk/terminal/command_tree.h"

namespace mbk::app {

/// A self-contained script with which a shell completes the command line of `root`.
[[nodiscard]] std::string bash_completion(const CommandText& root);
[[nodiscard]] std::string zsh_completion(const CommandText& root);
[[nodiscard]] std::string fish_completion(const CommandText& root);

/// 'text' as a word that a POSIX shell does not touch.
[[nodiscard]] std::string single_quoted(const std::string& text);

}  // namespace mbk::app
