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

/// With which permissions a file is made.
struct Mode {
  mode_t bits = 0666;
  bool whatever_the_umask = false;
  std::optional<gid_t> group;  ///< the group that may read the file; a file of another group is for its owner alone
};

/// A file that is made here, so that nothing that is there is followed or replaced, and on the disk when this ends.
int write_new(const fs::path& file, std::string_view text, const Mode& mode) {
  const int descriptor =
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode.whatever_the_umask ? 0600 : mode.bits);
  if (descriptor < 0) return errno;
  int code = mode.whatever_the_umask && ::fchmod(descriptor, mode.bits) != 0 ? errno : 0;
  if (struct stat made{}; code == 0 && mode.group) {
    if (::fstat(descriptor, &made) != 0 || (made.st_gid != *mode.group && ::fchmod(descriptor, 0600) != 0))
      code = errno;
  }
  if (code == 0) code = write_whole(descriptor, text);
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
    return fail(ErrorKind::usage, "the file already exists", "pass --overwrite to replace it", file.string());
  }
  return bad_data(fmt::format("cannot be written: {}", std::generic_category().message(code)),
                  code == ENAMETOOLONG
                      ? "choose a shorter name: about twenty characters are added while it is being written"
                      : "check the folder, its permissions and the space on the disk",
                  file.string());
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
    return fail(ErrorKind::usage, "this is not a regular file and cannot be replaced", "choose another name",
                file.string());
  }
  return {};
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// The temporary name of a file during writing; it does not exist yet.
fs::path temporary_name(const fs::path& file) {
  fs::path name = folder_of(file) / fmt::format(".{}.{}.part", file.filename().string(), ::getpid());
  ::unlink(name.c_str());  // of a process of that number that went down
  return name;
}

Result<void> not_begun(const fs::path& file, const Temporary& temporary, int code) {
  if (code != EEXIST) return cannot_write(file, code);
  return bad_data(fmt::format("its temporary file {} exists and cannot be removed", temporary.path.filename().string()),
                  "remove that file, and check the folder's permissions and the disk", file.string());
}

Result<void> write_as(const fs::path& file, bool overwrite, std::string_view text, const Mode& mode) {
  MBK_TRY(check_name(file, overwrite));
  const Temporary temporary{temporary_name(file)};
  if (const int error = write_new(temporary.path, text, mode); error != 0) return not_begun(file, temporary, error);
  if (const int error = give_name(temporary.path, file, overwrite); error != 0) return cannot_write(file, error);
  if (const int error = flush_names(folder_of(file)); error != 0) return cannot_write(file, error);
  return {};
}

/// Who may read all of the files that were looked at.
struct CommonReaders {
  Readers readers = Readers::all;
  std::optional<gid_t> group;  ///< where it is that group's members

  void restrict_to(const fs::path& path) {
    struct stat found {};
    if (readers == Readers::owner) return;
    if (::stat(path.c_str(), &found) != 0) {
      readers = Readers::owner;
    } else if ((found.st_mode & S_IROTH) == 0) {
      const bool same = !group || *group == found.st_gid;
      readers = same && (found.st_mode & S_IRGRP) != 0 ? Readers::group : Readers::owner;
      group = found.st_gid;
    }
  }
};

/// Who may read a file, or a folder and all that is in it.
CommonReaders common_readers(const std::vector<fs::path>& paths) {
  CommonReaders common;
  for (const fs::path& path : paths) {
    common.restrict_to(path);
    std::error_code code;
    if (!fs::is_directory(path, code)) continue;
    for (fs::recursive_directory_iterator at(path, code), end; !code && at != end; at.increment(code)) {
      common.restrict_to(at->path());
      if (common.readers == Readers::owner) break;
    }
    if (code) common.readers = Readers::owner;
  }
  return common;
}

}  // namespace

Result<void> write_file(const fs::path& file, bool overwrite, std::string_view text, std::optional<Readers> readers) {
  return write_as(file, overwrite, text, readers ? Mode{permissions(*readers), true, {}} : Mode{});
}

Result<void> can_write_file(const fs::path& file, bool overwrite) {
  MBK_TRY(check_name(file, overwrite));
  const Temporary temporary{temporary_name(file)};
  if (const int error = write_new(temporary.path, {}, {0600}); error != 0) return not_begun(file, temporary, error);
  return {};
}

Readers readers_of(const fs::path& file) {
  return common_readers({file}).readers;
}

Result<void> write_derived(const fs::path& file, bool overwrite, std::string_view text,
                           const std::vector<fs::path>& sources) {
  std::vector<fs::path> all = sources;
  std::error_code code;
  if (fs::is_regular_file(file, code)) all.push_back(file);
  const CommonReaders common = common_readers(all);
  if (common.readers == Readers::all) return write_as(file, overwrite, text, {});
  const bool of_group = common.readers == Readers::group;
  return write_as(file, overwrite, text, {permissions(common.readers), false, of_group ? common.group : std::nullopt});
}

}  // namespace mbk::recording
