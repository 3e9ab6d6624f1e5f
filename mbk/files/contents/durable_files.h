#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "mbk/base/core/result.h"

/// Files that exist completely or not at all, however the process ends.
namespace mbk::files {

/// "FILE: what: No space left on device", with a remedy.   @param code  errno
[[nodiscard]] tl::unexpected<Error> cannot(const char* what, const std::filesystem::path& file, int code);

/// Creates a folder for the owner only, on the disk when this returns; succeeds if it exists.
[[nodiscard]] Result<void> make_folder(const std::filesystem::path& folder);

/// Calls `take` with the contents of a file, piece by piece.   @fails  data: it cannot be read; as `take`.
[[nodiscard]] Result<void> read_pieces(const std::filesystem::path& file,
                                       const std::function<Result<void>(std::span<const std::byte>)>& take);

struct CopiedFile {
  std::string sha256;
  std::int64_t bytes = 0;
};

/// A copy for the owner only under a new name, on the disk when this returns; a failure leaves no file.
[[nodiscard]] Result<CopiedFile> copy_hashed(const std::filesystem::path& from, const std::filesystem::path& to);

/// Renames a file, and waits until the disk has it.
[[nodiscard]] Result<void> rename_on_disk(const std::filesystem::path& from, const std::filesystem::path& to);

/// Flushes the names in a folder to the disk.
[[nodiscard]] Result<void> flush_folder(const std::filesystem::path& folder);

/// Removes a file; succeeds if there is none.   @returns  whether there was one
[[nodiscard]] Result<bool> remove_file(const std::filesystem::path& file);

/// The hash of a file's bytes.   @fails  data: it cannot be read.
[[nodiscard]] Result<std::string> file_sha256(const std::filesystem::path& file);

}  // namespace mbk::files
