#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "mbk/base/core/result.h"

/// The files of a study's folder.
namespace mbk::store {

/// How long others may hold a lock before whoever waits for it is told, and before it gives up.
inline constexpr std::chrono::milliseconds kUnnoticedWait(200), kLongestWait(30000);

/// A lock on a study's folder, which ends with the process however that ends. Those who add files share it; whoever
/// removes some, or copies all, has it alone.
class FolderLock {
 public:
  enum class Kind { shared, alone };

  /// Waits for others, half a minute at most.   @fails  data: it cannot be had.
  [[nodiscard]] static Result<std::unique_ptr<FolderLock>> take(const std::filesystem::path& folder, Kind kind,
                                                                const std::function<void()>& waiting);

  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  explicit FolderLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

/// "recordings/ab/ab12….h5"
[[nodiscard]] std::string stored_name(const std::string& sha256, const std::string& extension);

/// The end of a file's name, as it is kept: of small letters and digits, with its dot; otherwise "".
[[nodiscard]] std::string kept_extension(const std::filesystem::path& file);

/// Names that nothing refers to.
[[nodiscard]] bool is_temporary(const std::filesystem::path& file);

/// Makes a folder for the owner alone, on the disk when this ends; fine where it is there.
[[nodiscard]] Result<void> make_folder(const std::filesystem::path& folder);

/// Calls `take` with what a file holds, piece by piece.   @fails  data: it cannot be read; as `take`.
[[nodiscard]] Result<void> read_pieces(const std::filesystem::path& file,
                                       const std::function<Result<void>(std::span<const std::byte>)>& take);

struct CopiedFile {
  std::string sha256;
  std::int64_t bytes = 0;
};

/// A copy for the owner alone under a name that is not there yet, on the disk when this ends; what fails leaves
/// nothing.
[[nodiscard]] Result<CopiedFile> copy_hashed(const std::filesystem::path& from, const std::filesystem::path& to);

/// Renames a file, and waits until the disk has it.
[[nodiscard]] Result<void> rename_on_disk(const std::filesystem::path& from, const std::filesystem::path& to);

/// A folder's names are on the disk.
[[nodiscard]] Result<void> flush_folder(const std::filesystem::path& folder);

/// Removes a file, fine where there is none.   @returns  whether there was one
[[nodiscard]] Result<bool> remove_file(const std::filesystem::path& file);

}  // namespace mbk::store
