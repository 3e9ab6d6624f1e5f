#pragma once

// Files that the tests write themselves, and folders that go away.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "mbk/files/contents/test_bytes.h"

namespace mbk::recording::test {

/// A folder of one test.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "mbk_recording_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

  std::filesystem::path write(std::string_view name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The folder of real recordings, or "" where there is none.
inline std::string data_folder() {
  const char* folder = std::getenv("MBK_DATA_DIR");
  return folder == nullptr ? "" : folder;
}

#define MBK_DATA_OR_SKIP(folder)                                              \
  const std::filesystem::path folder = ::mbk::recording::test::data_folder(); \
  if (folder.empty()) GTEST_SKIP() << "MBK_DATA_DIR is not set"

}  // namespace mbk::recording::test
