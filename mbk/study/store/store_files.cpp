#include "mbk/study/store/store_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>

#include "mbk/files/contents/durable_files.h"

namespace mbk::store {

namespace fs = std::filesystem;

Result<std::unique_ptr<FolderLock>> FolderLock::take(const fs::path& folder, Kind kind,
                                                     const std::function<void()>& waiting) {
  const fs::path file = folder / "lock";
  system::OpenFile opened = system::create_or_open(file);
  if (!opened && (errno == EACCES || errno == EROFS)) {  // who may only read can lock it as well
    opened = system::open_to_read(file);
  }
  if (!opened) return files::cannot("cannot be locked", file, errno);
  std::unique_ptr<FolderLock> lock(new FolderLock(std::move(opened)));
  const auto began = std::chrono::steady_clock::now();
  bool told = !waiting;
  const auto how = kind == Kind::shared ? system::Lock::shared : system::Lock::alone;
  while (const int code = system::try_lock(lock->file_, how)) {
    if (code != EWOULDBLOCK) return files::cannot("cannot be locked", file, code);
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
