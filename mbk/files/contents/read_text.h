#pragma once

#include <filesystem>
#include <string>

#include "mbk/base/core/result.h"

namespace mbk {

/// The whole of a text file, at most 256 MB, or the document that whoever this thread works for has under that name.
/// @fails  data: it is not there, cannot be read, is empty or larger.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& file);

}  // namespace mbk
