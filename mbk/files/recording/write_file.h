#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/trial/readers.h"

namespace mbk::recording {

/// Writes a file that appears completely or not at all: it is written under a temporary name in the same folder,
/// flushed to the disk and renamed. A failure leaves nothing behind, except that the file exists if only the folder
/// cannot be flushed.
/// @param readers  who may read it; absent: as the umask permits
/// @fails  usage: the file exists and `overwrite` is false. data: the folder cannot be written, the disk is full.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& file, bool overwrite, std::string_view text,
                                      std::optional<Readers> readers = std::nullopt);

/// Checks a name as write_file would: creates the temporary file and removes it again.
/// @fails  as write_file, except for a full disk
[[nodiscard]] Result<void> can_write_file(const std::filesystem::path& file, bool overwrite);

/// Who may read an existing file, or every file of a folder; the owner alone if the permissions are unknown.
[[nodiscard]] Readers readers_of(const std::filesystem::path& file);

/// Writes results computed from `sources`, as `write_file` does: readable only by those who may read every source and
/// the replaced file. The umask may remove more.
[[nodiscard]] Result<void> write_derived(const std::filesystem::path& file, bool overwrite, std::string_view text,
                                         const std::vector<std::filesystem::path>& sources);

}  // namespace mbk::recording
