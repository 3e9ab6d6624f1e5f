#include "mbk/study/store/store_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "mbk/files/contents/durable_files.h"

namespace mbk::store {

namespace fs = std::filesystem;

Result<std::unique_ptr<FolderLock>> FolderLock::take(const fs::path& folder, Kind kind,
                                                     const std::function<void()>& waiting) {
  const fs::path file = folder / "lock";
  int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (descriptor < 0 && (errno == EACCES || errno == EROFS)) {  // who may only read can lock it as well
    descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  }
  if (descriptor < 0) return files::cannot("cannot be locked", file, errno);
  std::unique_ptr<FolderLock> lock(new FolderLock(descriptor));
  const auto began = std::chrono::steady_clock::now();
  bool told = !waiting;
  while (::flock(descriptor, (kind == Kind::shared ? LOCK_SH : LOCK_EX) | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) return files::cannot("cannot be locked", file, errno);
    const auto waited = std::chrono::steady_clock::now() - began;
    if (!told && waited > kUnnoticedWait) {
      told = true;
      waiting();
    }
    if (waited > kLongestWait) {
      return bad_data("another process is changing the files of the study", "try again when it has finished",
                      folder.string());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return lock;
}

FolderLock::~FolderLock() {
  ::close(descriptor_);
}

std::string stored_name(const std::string& sha256, const std::string& extension) {
  return fmt::format("recordings/{}/{}{}", sha256.substr(0, 2), sha256, extension);
}

std::string kept_extension(const fs::path& file) {
  constexpr std::size_t kLongest = 9;
  std::string end = file.extension().string();
  for (char& letter : end) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); };
  if (end.size() < 2 || end.size() > kLongest || !std::all_of(end.begin() + 1, end.end(), plain)) return "";
  return end;
}

bool is_temporary(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with(".") && name.ends_with(".part");
}

}  // namespace mbk::store
