#include "mbk/files/recording/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "mbk/files/recording/memory.h"

namespace mbk::recording {
namespace {

std::string reason(int code) {
  return std::generic_category().message(code);
}

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

}  // namespace

Result<Buffer> read_file(const std::filesystem::path& file) {
  // O_NONBLOCK: opening a pipe must not wait for its writer.
  const Descriptor descriptor{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (descriptor.number < 0) {
    if (errno == ENOENT) return bad_data("there is no such file", "check the name and the folder");
    return bad_data(fmt::format("cannot be opened: {}", reason(errno)), "check its permissions");
  }
  struct stat status {};
  if (::fstat(descriptor.number, &status) != 0) return bad_data(fmt::format("cannot be read: {}", reason(errno)));
  if (S_ISDIR(status.st_mode)) return bad_data("is a folder, not a file", "name the recording in it");
  if (!S_ISREG(status.st_mode)) return bad_data("is not a regular file", "copy the recording to a file first");
  if (status.st_size == 0) return bad_data("the file is empty", "nothing was recorded, or the copy failed");
  if (static_cast<std::uint64_t>(status.st_size) > kLargestFile) {
    return bad_data(fmt::format("file size {} bytes is above the limit of {}", status.st_size, kLargestFile),
                    "split the recording into numbered parts");
  }
  // The numbers in it take at least as much again, before its bytes can go.
  if (auto ok = check_memory(2 * static_cast<std::uint64_t>(status.st_size)); !ok) return tl::unexpected(ok.error());

  Buffer buffer(static_cast<std::size_t>(status.st_size));
  for (std::size_t done = 0; done < buffer.size;) {
    const ssize_t got = ::read(descriptor.number, buffer.data.get() + done, buffer.size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return bad_data(fmt::format("cannot be read: {}", reason(errno)));
    if (got == 0) return bad_data("the file became shorter while it was read", "wait until it is written completely");
    done += static_cast<std::size_t>(got);
  }
  return buffer;
}

}  // namespace mbk::recording
