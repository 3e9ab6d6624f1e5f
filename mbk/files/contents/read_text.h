#pragma once

#include <filesystem>
#include <string>

#include "mbk/base/core/result.h"

namespace mbk {

/// A whole text file of at most 256 MB, or the document of that name from the requester of this thread.
/// @fails  data: it does not exist, cannot be read, is empty or larger.
[[nodiscard]] Result<std::string> read_text(const std::filesystem::path& file);

}  // namespace mbk
