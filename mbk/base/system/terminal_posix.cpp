#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string_view>

#include "mbk/base/system/terminal.h"

namespace mbk::system {

bool is_terminal(int descriptor) {
  return ::isatty(descriptor) == 1;
}

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

bool shows_colours(int /*descriptor*/) {
  const char* const kind = std::getenv("TERM");
  return kind != nullptr && std::string_view(kind) != "dumb";
}

bool prepare_streams() noexcept {
  for (int descriptor = kInput; descriptor <= kError; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest free number is this one. For reading alone: what is written there has to fail.
    if (open("/dev/null", O_RDONLY) != descriptor && open("/", O_RDONLY) != descriptor) return false;
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  return true;
}

bool wait_for_room(int descriptor, std::chrono::milliseconds longest) noexcept {
  pollfd output{descriptor, POLLOUT, 0};
  return poll(&output, 1, static_cast<int>(longest.count())) != 0;
}

void end_without_reader() noexcept {
  std::signal(SIGPIPE, SIG_DFL);
  std::raise(SIGPIPE);
}

}  // namespace mbk::system
