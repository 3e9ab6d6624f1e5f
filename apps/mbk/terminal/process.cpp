#include "apps/mbk/terminal/process.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

#include "apps/mbk/options/output.h"

namespace mbk::app {

void prepare_process() noexcept {
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    // The lowest free number is this one. For reading alone: what is written there has to fail.
    if (open("/dev/null", O_RDONLY) == descriptor || open("/", O_RDONLY) == descriptor) continue;
    std::_Exit(kBadData);  // nobody can be told
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace mbk::app
