#include "mbk/files/recording/write_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace mbk::recording {
namespace {

namespace fs = std::filesystem;

/// The functions below give 0, or the error code.

int write_whole(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t wrote = ::write(descriptor, text.data(), text.size());
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return wrote < 0 ? errno : ENOSPC;
    text.remove_prefix(static_cast<std::size_t>(wrote));
  }
  return 0;
}

/// A file that is made here, so that nothing that is there is followed or replaced, and on the disk when this ends.
int write_new(const fs::path& file, std::string_view text, std::optional<Readers> readers) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, readers ? 0600 : 0666);
  if (descriptor < 0) return errno;
  int code = readers && ::fchmod(descriptor, permissions(*readers)) != 0 ? errno : write_whole(descriptor, text);
  if (code == 0 && ::fsync(descriptor) != 0) code = errno;
  if (::close(descriptor) != 0 && code == 0) code = errno;
  return code;
}

/// A folder's names are on the disk.
int flush_names(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int code = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return code == EINVAL ? 0 : code;  // file systems that cannot say so
}

/// Gives a file its name; where that is taken it is an error unless it may be replaced, however late it was taken.
int give_name(const fs::path& from, const fs::path& to, bool overwrite) {
  if (overwrite) return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  return ::link(from.c_str(), to.c_str()) == 0 ? 0 : errno;  // file systems that cannot do that; `from` goes away
}

/// A file that goes away unless it was renamed.
struct Temporary {
  fs::path path;
  ~Temporary() { ::unlink(path.c_str()); }
};

Result<void> cannot_write(const fs::path& file, int code) {
  if (code == EEXIST) {
    return fail(ErrorKind::usage, "the file is there already", "pass --overwrite to replace it", file.string());
  }
  return bad_data(fmt::format("cannot be written: {}", std::generic_category().message(code)),
                  "check the folder, its permissions and the space on the disk", file.string());
}

/// Nothing is under the name, or a file that may be replaced.
Result<void> check_name(const fs::path& file, bool overwrite) {
  std::error_code code;
  const fs::file_type name = fs::symlink_status(file, code).type(), type = fs::status(file, code).type();
  if (name == fs::file_type::none || type == fs::file_type::none) {
    return cannot_write(file, code ? code.value() : EIO);
  }
  if (!overwrite && name != fs::file_type::not_found) return cannot_write(file, EEXIST);
  if (type != fs::file_type::not_found && type != fs::file_type::regular) {
    return fail(ErrorKind::usage, "is no file that could be replaced", "choose another name", file.string());
  }
  return {};
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// The name under which a file is written before it gets its own; nothing stands there.
fs::path temporary_name(const fs::path& file) {
  fs::path name = folder_of(file) / fmt::format(".{}.{}.part", file.filename().string(), ::getpid());
  ::unlink(name.c_str());  // of a process of that number that went down
  return name;
}

}  // namespace

Result<void> write_file(const fs::path& file, bool overwrite, std::string_view text, std::optional<Readers> readers) {
  if (auto ok = check_name(file, overwrite); !ok) return ok;
  const Temporary temporary{temporary_name(file)};
  if (const int error = write_new(temporary.path, text, readers); error != 0) return cannot_write(file, error);
  if (const int error = give_name(temporary.path, file, overwrite); error != 0) return cannot_write(file, error);
  if (const int error = flush_names(folder_of(file)); error != 0) return cannot_write(file, error);
  return {};
}

Result<void> can_write_file(const fs::path& file, bool overwrite) {
  if (auto ok = check_name(file, overwrite); !ok) return ok;
  const Temporary temporary{temporary_name(file)};
  if (const int error = write_new(temporary.path, {}, Readers::owner); error != 0) return cannot_write(file, error);
  return {};
}

Readers readers_of(const fs::path& file) {
  std::error_code code;
  const fs::perms allowed = fs::status(file, code).permissions();
  if (code || allowed == fs::perms::unknown) return Readers::owner;
  if ((allowed & fs::perms::others_read) != fs::perms::none) return Readers::all;
  return (allowed & fs::perms::group_read) != fs::perms::none ? Readers::group : Readers::owner;
}

}  // namespace mbk::recording
