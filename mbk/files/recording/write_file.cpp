#include "mbk/files/recording/write_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <span>
#include <system_error>

#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"

namespace mbk::recording {
namespace {

namespace fs = std::filesystem;

/// With which permissions a file is made.
struct Mode {
  unsigned bits = 0666;
  bool whatever_the_umask = false;
  std::optional<std::uint64_t> group;  ///< that may read the file; a file of another group is for its owner alone
};

/// A file that is made here, so that nothing that is there is followed or replaced, and on the disk when this ends.
int write_new(const fs::path& file, std::string_view text, const Mode& mode) {
  system::OpenFile out = system::create_new(file, mode.whatever_the_umask ? 0600 : mode.bits);
  if (!out) return errno;
  int code = mode.whatever_the_umask ? system::set_permissions(out, mode.bits) : 0;
  if (code == 0 && mode.group) {
    const auto made = system::status_of(out);
    code = !made ? errno : made->group != *mode.group ? system::set_permissions(out, 0600) : 0;
  }
  if (code == 0) code = system::write_all(out.number(), std::as_bytes(std::span(text)));
  if (code == 0) code = system::flush(out);
  if (const int closed = out.close(); code == 0) code = closed;
  return code;
}

/// Gives a file its name; where that is taken it is an error unless it may be replaced, however late it was taken.
int give_name(const fs::path& from, const fs::path& to, bool overwrite) {
  return overwrite ? system::rename_over(from, to) : system::rename_new(from, to);
}

/// A file that goes away unless it was renamed.
struct Temporary {
  fs::path path;
  ~Temporary() { system::remove_name(path); }
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
  fs::path name = folder_of(file) / fmt::format(".{}.{}.part", file.filename().string(), system::process_id());
  system::remove_name(name);  // of a process of that number that went down
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
  if (const int error = system::flush_folder(folder_of(file)); error != 0) return cannot_write(file, error);
  return {};
}

/// Who may read all of the files that were looked at.
struct CommonReaders {
  Readers readers = Readers::all;
  std::optional<std::uint64_t> group;  ///< where it is that group's members

  void restrict_to(const fs::path& path) {
    if (readers == Readers::owner) return;
    constexpr unsigned kOthersRead = 04, kGroupReads = 040;
    const auto found = system::status_of(path);
    if (!found) {
      readers = Readers::owner;
    } else if ((found->permissions & kOthersRead) == 0) {
      const bool same = !group || *group == found->group;
      readers = same && (found->permissions & kGroupReads) != 0 ? Readers::group : Readers::owner;
      group = found->group;
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
