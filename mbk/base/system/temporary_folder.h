#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "mbk/base/core/result.h"
#include "mbk/base/system/files.h"

namespace mbk {

/// A folder that is removed at the end of its lifetime.
class TemporaryFolder {
 public:
  /// @fails  data: it cannot be created
  static Result<TemporaryFolder> create(const std::string& prefix) {
    std::error_code ignored;  // then it cannot be created
    const std::filesystem::path begin = std::filesystem::temp_directory_path(ignored) / prefix;
    std::filesystem::path made = system::make_temporary_folder(begin);
    if (made.empty()) {
      return bad_data("no temporary folder could be created", "set TMPDIR to a folder that exists", begin.string());
    }
    return TemporaryFolder(std::move(made));
  }
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace mbk
