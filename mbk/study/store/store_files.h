#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "mbk/base/core/result.h"
#include "mbk/base/system/files.h"

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
  ~FolderLock() = default;

 private:
  explicit FolderLock(system::OpenFile file) : file_(std::move(file)) {}
  system::OpenFile file_;
};

/// "recordings/ab/ab12….h5"
[[nodiscard]] std::string stored_name(const std::string& sha256, const std::string& extension);

/// The end of a file's name, as it is kept: of small letters and digits, with its dot; otherwise "".
[[nodiscard]] std::string kept_extension(const std::filesystem::path& file);

/// Names that nothing refers to.
[[nodiscard]] bool is_temporary(const std::filesystem::path& file);

}  // namespace mbk::store
