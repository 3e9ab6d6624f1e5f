#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "mbk/base/core/result.h"

namespace mbk::config {

/// The first bytes of a text file, one more than `largest` if it is larger.
/// @fails  data: the file does not exist or cannot be read, or it is a folder, a device or a pipe, whose writer might
///         never come.
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& file, std::size_t largest);

}  // namespace mbk::config
