#pragma once

#include <filesystem>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// Expands FILE arguments in the given order: a folder to its recordings, a pattern (* ? [a-z]) to the matching files,
/// both in natural order; a BIDS data set, a file and a recording in memory stay as they are. An existing name is never
/// read as a pattern.
/// @fails  data: the folder contains no recording, or cannot be read; no file matches the pattern.
[[nodiscard]] Result<std::vector<std::filesystem::path>> named_files(const std::vector<std::filesystem::path>& typed);

}  // namespace mbk::recording
