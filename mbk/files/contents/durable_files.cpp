#include "mbk/files/contents/durable_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <vector>

#include "mbk/files/contents/sha256.h"

namespace mbk::files {
namespace {

namespace fs = std::filesystem;

/// A descriptor that is closed.
struct OpenedFile {
  int value = -1;
  ~OpenedFile() {
    if (value >= 0) ::close(value);
  }
};

int write_whole(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t wrote = ::write(descriptor, bytes.data(), bytes.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return wrote < 0 ? errno : ENOSPC;
    bytes = bytes.subspan(static_cast<std::size_t>(wrote));
  }
  return 0;
}

int sync_file(int descriptor) {
  while (::fsync(descriptor) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

}  // namespace

tl::unexpected<Error> cannot(const char* what, const fs::path& file, int code) {
  const char* const remedy = code == ENOSPC || code == EDQUOT || code == EFBIG
                                 ? "free space on the disk; no file was partially changed"
                             : code == ENOENT ? "check the name"
                             : code == EACCES ? "check its permissions"
                                              : "check the disk and the permissions of the folder";
  return bad_data(fmt::format("{}: {}", what, std::generic_category().message(code)), remedy, file.string());
}

Result<void> make_folder(const fs::path& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0) {
    const int code = errno;
    std::error_code ignored;
    if (code != EEXIST || !fs::is_directory(folder, ignored))
      return cannot("the folder cannot be created", folder, code);
    // Whoever made it may not have waited for the disk yet, or failed to.
  }
  return flush_folder(folder.has_parent_path() ? folder.parent_path() : fs::path("."));
}

Result<void> read_pieces(const fs::path& file, const std::function<Result<void>(std::span<const std::byte>)>& take) {
  const OpenedFile in{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};  // a pipe's writer might never come
  if (in.value < 0) return cannot("cannot be read", file, errno);
  struct stat status {};
  if (::fstat(in.value, &status) != 0) return cannot("cannot be read", file, errno);
  if (!S_ISREG(status.st_mode)) return bad_data("this is not a file", "name a recording", file.string());
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  std::vector<std::byte> piece(kPiece);
  while (true) {
    const ssize_t got = ::read(in.value, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return cannot("cannot be read", file, errno);
    if (got == 0) return {};
    MBK_TRY(take(std::span(piece).first(static_cast<std::size_t>(got))));
  }
}

Result<CopiedFile> copy_hashed(const fs::path& from, const fs::path& to) {
  OpenedFile out{::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)};
  if (out.value < 0) return cannot("cannot be written", to, errno);
  CopiedFile copied;
  recording::Sha256 sum;
  auto done = read_pieces(from, [&](std::span<const std::byte> piece) -> Result<void> {
    sum.add(piece);
    copied.bytes += std::ssize(piece);
    if (const int code = write_whole(out.value, piece); code != 0) return cannot("cannot be written", to, code);
    return {};
  });
  if (done) {
    if (const int code = sync_file(out.value); code != 0) done = cannot("cannot be written", to, code);
  }
  const int closed = ::close(out.value);
  out.value = -1;
  if (done && closed != 0) done = cannot("cannot be written", to, errno);
  if (!done) {
    ::unlink(to.c_str());
    return tl::unexpected(done.error());
  }
  copied.sha256 = sum.hex();
  return copied;
}

Result<void> rename_on_disk(const fs::path& from, const fs::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) return cannot("cannot be written", to, errno);
  return flush_folder(to.parent_path());
}

Result<void> flush_folder(const fs::path& folder) {
  const OpenedFile opened{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (opened.value < 0) return cannot("cannot be written", folder, errno);
  const int code = sync_file(opened.value);
  if (code != 0 && code != EINVAL) return cannot("cannot be written", folder, code);  // EINVAL: it cannot say so
  return {};
}

Result<bool> remove_file(const fs::path& file) {
  if (::unlink(file.c_str()) == 0) return true;
  if (errno == ENOENT) return false;
  return cannot("cannot be removed", file, errno);
}

Result<std::string> file_sha256(const fs::path& file) {
  recording::Sha256 sum;
  MBK_TRY(read_pieces(file, [&](std::span<const std::byte> piece) -> Result<void> {
    sum.add(piece);
    return {};
  }));
  return sum.hex();
}

}  // namespace mbk::files
