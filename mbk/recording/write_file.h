#pragma once

#include <filesystem>
#include <string_view>

#include "mbk/core/result.h"

namespace mbk::recording {

/// Makes a file that appears whole or not at all: it is written under a temporary name in the same folder, flushed to
/// the disk and renamed. What fails leaves nothing behind; only where the folder cannot be flushed the file is there.
/// @fails  usage: the file is there and `overwrite` is false. data: the folder cannot be written, the disk is full.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, bool overwrite, std::string_view text);

}  // namespace mbk::recording
