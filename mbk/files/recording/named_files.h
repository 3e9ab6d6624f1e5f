#pragma once

#include <filesystem>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::recording {

/// What FILEs stand for, in the order in which they were typed: a folder for the recordings that lie in it, a pattern
/// (* ? [a-z]) for the files that fit, both in natural order; a BIDS data set, a file and what is in memory for itself.
/// A name that is there is never taken for a pattern.
/// @fails  data: the folder holds no recording, or cannot be read; no file fits the pattern.
[[nodiscard]] Result<std::vector<std::filesystem::path>> named_files(const std::vector<std::filesystem::path>& typed);

}  // namespace mbk::recording
