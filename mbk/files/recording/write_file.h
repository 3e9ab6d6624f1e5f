#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/readers.h"

namespace mbk::recording {

/// Makes a file that appears whole or not at all: it is written under a temporary name in the same folder, flushed to
/// the disk and renamed. What fails leaves nothing behind; only where the folder cannot be flushed the file is there.
/// @param readers  who may read it; where absent, what the umask leaves
/// @fails  usage: the file is there and `overwrite` is false. data: the folder cannot be written, the disk is full.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, bool overwrite, std::string_view text,
                                      std::optional<Readers> readers = std::nullopt);

/// Asks of a name what write_file would: opens what would be renamed, and removes it again.
/// @fails  as write_file, but for a disk that is full
[[nodiscard]] Result<void> can_write_file(const std::filesystem::path& file, bool overwrite);

/// Who may read a file that is there, or every file of a folder; the owner alone if the permissions are unknown.
[[nodiscard]] Readers readers_of(const std::filesystem::path& file);

/// Writes what was computed from `sources`, as `write_file` does: only those may read it who may read every source, and
/// the file that it replaces. The umask may remove more.
[[nodiscard]] Result<void> write_derived(const std::filesystem::path& file, bool overwrite, std::string_view text,
                                         const std::vector<std::filesystem::path>& sources);

}  // namespace mbk::recording
