#include "mbk/recording/write_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>

namespace mbk::recording {
namespace {

namespace fs = std::filesystem;

/// Flushes a file or folder to the disk; 0 or the error code.
int flush(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int code = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return code;
}

/// A file that goes away unless it was renamed.
struct Temporary {
  fs::path path;
  ~Temporary() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
};

}  // namespace

Result<void> write_file(const fs::path& file, bool overwrite, const std::function<bool(const fs::path&)>& fill,
                        std::optional<Readers> readers) {
  const auto cannot = [&](int code) {
    return bad_data(fmt::format("cannot be written: {}", std::generic_category().message(code)),
                    "check the folder, its permissions and the space on the disk", file.string());
  };
  std::error_code code;
  if (!overwrite && fs::exists(fs::symlink_status(file, code))) {
    return fail(ErrorKind::usage, "the file is there already", "pass --overwrite to replace it", file.string());
  }
  if (const auto status = fs::status(file, code); fs::exists(status) && !fs::is_regular_file(status)) {
    return fail(ErrorKind::usage, "is no file that could be replaced", "choose another name", file.string());
  }
  fs::path folder = file.parent_path();
  if (folder.empty()) folder = ".";
  const Temporary temporary{folder / fmt::format(".{}.{}.part", file.filename().string(), ::getpid())};
  // Made by us, so that nothing that is there is followed or replaced.
  fs::remove(temporary.path, code);
  const int made = ::open(temporary.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, readers ? 0600 : 0666);
  if (made < 0) return cannot(errno);
  const int refused = readers && ::fchmod(made, permissions(*readers)) != 0 ? errno : 0;
  ::close(made);
  if (refused != 0) return cannot(refused);
  if (!fill(temporary.path)) return cannot(EIO);
  if (const int error = flush(temporary.path); error != 0) return cannot(error);
  fs::rename(temporary.path, file, code);
  if (code) return cannot(code.value());
  if (const int error = flush(folder); error != 0) return cannot(error);
  return {};
}

Result<void> write_file(const fs::path& file, bool overwrite, std::string_view text, std::optional<Readers> readers) {
  const auto fill = [&](const fs::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.close();
    return stream.good();
  };
  return write_file(file, overwrite, fill, readers);
}

Readers readers_of(const fs::path& file) {
  std::error_code code;
  const fs::perms allowed = fs::status(file, code).permissions();
  if (code || allowed == fs::perms::unknown) return Readers::owner;
  if ((allowed & fs::perms::others_read) != fs::perms::none) return Readers::all;
  return (allowed & fs::perms::group_read) != fs::perms::none ? Readers::group : Readers::owner;
}

}  // namespace mbk::recording
