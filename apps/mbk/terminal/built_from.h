#pragma once

#include <string>

namespace mbk::app {

/// What `mbk --version` says: "mbk 1.0.0" and, in a release (tools/release), a line each for commit, compiler and the
/// versions of the libraries that the program holds.
[[nodiscard]] std::string built_from();

}  // namespace mbk::app
