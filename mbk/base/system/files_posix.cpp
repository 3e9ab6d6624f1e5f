#include <fcntl.h>
#include <glob.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "mbk/base/system/files.h"

namespace mbk::system {
namespace {

namespace fs = std::filesystem;

std::optional<FileStatus> status_from(int code, const struct stat& status) {
  if (code != 0) return std::nullopt;
  FileStatus found;
  found.kind = S_ISREG(status.st_mode)   ? FileStatus::Kind::regular
               : S_ISDIR(status.st_mode) ? FileStatus::Kind::folder
                                         : FileStatus::Kind::other;
  found.size = static_cast<std::uint64_t>(status.st_size);
  found.permissions = status.st_mode & 0777U;
  found.group = status.st_gid;
  found.number = status.st_ino;
  found.disk = status.st_dev;
  found.changed_ns = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
  return found;
}

int error_of(int code) {
  return code == 0 ? 0 : errno;
}

}  // namespace

int OpenFile::close() {
  return number_ < 0 ? 0 : error_of(::close(std::exchange(number_, -1)));
}

OpenFile open_to_read(const fs::path& file) {
  return OpenFile(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
}

OpenFile create_new(const fs::path& file, unsigned permissions) {
  return OpenFile(::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, permissions));
}

OpenFile create_or_open(const fs::path& file) {
  return OpenFile(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
}

OpenFile open_unnamed(const fs::path& folder) {
  return OpenFile(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR));
}

std::optional<FileStatus> status_of(const OpenFile& file) {
  struct stat status {};
  const int code = ::fstat(file.number(), &status);
  return status_from(code, status);
}

std::optional<FileStatus> status_of(const fs::path& file) {
  struct stat status {};
  const int code = ::stat(file.c_str(), &status);
  return status_from(code, status);
}

std::int64_t read_some(int descriptor, void* to, std::size_t count) {
  while (true) {
    const ssize_t got = ::read(descriptor, to, count);
    if (got >= 0 || errno != EINTR) return got;
  }
}

std::int64_t read_some_at(int descriptor, void* to, std::size_t count, std::uint64_t place) {
  while (true) {
    const ssize_t got = ::pread(descriptor, to, count, static_cast<off_t>(place));
    if (got >= 0 || errno != EINTR) return got;
  }
}

int write_all(int descriptor, std::span<const std::byte> bytes, std::size_t* wrote) {
  std::size_t unused = 0, &done = wrote != nullptr ? *wrote : unused;
  for (done = 0; done < bytes.size();) {
    const ssize_t more = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return more < 0 ? errno : ENOSPC;
    done += static_cast<std::size_t>(more);
  }
  return 0;
}

int write_all_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t place) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t more =
        ::pwrite(descriptor, bytes.data() + done, bytes.size() - done, static_cast<off_t>(place + done));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) return more < 0 ? errno : ENOSPC;
    done += static_cast<std::size_t>(more);
  }
  return 0;
}

int cut(const OpenFile& file, std::uint64_t bytes) {
  return error_of(::ftruncate(file.number(), static_cast<off_t>(bytes)));
}

int set_permissions(const OpenFile& file, unsigned permissions) {
  return error_of(::fchmod(file.number(), permissions));
}

int flush(const OpenFile& file) {
  while (::fsync(file.number()) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

int flush_folder(const fs::path& folder) {
  const OpenFile opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened) return errno;
  const int code = flush(opened);
  return code == EINVAL ? 0 : code;
}

int try_lock(const OpenFile& file, Lock lock) {
  const int code = error_of(::flock(file.number(), (lock == Lock::shared ? LOCK_SH : LOCK_EX) | LOCK_NB));
  return code == EINTR ? EWOULDBLOCK : code;
}

int rename_over(const fs::path& from, const fs::path& to) {
  return error_of(::rename(from.c_str(), to.c_str()));
}

int rename_new(const fs::path& from, const fs::path& to) {
  const int code = error_of(::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE));
  if (code != EINVAL && code != ENOSYS) return code;
  const int linked = system::link(from, to);  // a file system that cannot do that
  if (linked == 0) ::unlink(from.c_str());
  return linked;
}

int link(const fs::path& from, const fs::path& to) {
  return error_of(::link(from.c_str(), to.c_str()));
}

int remove_name(const fs::path& file) {
  return error_of(::unlink(file.c_str()));
}

int make_folder(const fs::path& folder) {
  return error_of(::mkdir(folder.c_str(), 0700));
}

fs::path make_temporary_folder(const fs::path& begin) {
  std::string name = begin.string() + "-XXXXXX";
  return ::mkdtemp(name.data()) == nullptr ? "" : name;
}

bool is_full(int code) {
  return code == ENOSPC || code == EDQUOT || code == EFBIG;
}

bool may_write(const fs::path& path) {
  return ::access(path.c_str(), W_OK) == 0;
}

fs::path find_program(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder) / name;
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  return {};
}

std::vector<fs::path> matching(const std::string& pattern) {
  glob_t found{};
  const int code = ::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &found);
  std::vector<fs::path> paths;
  for (std::size_t k = 0; code == 0 && k < found.gl_pathc; ++k) paths.emplace_back(found.gl_pathv[k]);
  ::globfree(&found);
  return paths;
}

}  // namespace mbk::system
