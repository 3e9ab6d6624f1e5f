#include "apps/mbk/terminal/stop_keys.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include "apps/mbk/terminal/last_words.h"

namespace mbk::app {

struct StopKeys::Terminal {
  termios before{};
};

StopKeys::StopKeys(session::LoopFlags& flags) {
  // only in the foreground: the keys of a program behind the shell are the shell's
  if (isatty(STDIN_FILENO) != 1 || tcgetpgrp(STDIN_FILENO) != getpgrp()) return;
  terminal_ = std::make_unique<Terminal>();
  tcgetattr(STDIN_FILENO, &terminal_->before);
  LastWords::restore_terminal(&terminal_->before);
  termios keys = terminal_->before;
  keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  watching_.emplace([&flags](const std::stop_token& over) { watch(flags, over); });
}

void StopKeys::watch(session::LoopFlags& flags, const std::stop_token& over) noexcept {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!over.stop_requested()) {
    constexpr int kWait = 20;  // [ms]
    if (poll(&input, 1, kWait) <= 0) continue;
    char key = 0;
    const ssize_t came = ::read(STDIN_FILENO, &key, 1);
    if (came < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (came != 1) {  // closed: nobody can stop the robot from there any more
      flags.end_session = true;
      flags.operator_stop = true;
      return;
    }
    if (key == ' ') flags.operator_stop = true;
    if (key == 'e') flags.end_trial = true;
  }
}

StopKeys::~StopKeys() {
  watching_.reset();
  LastWords::restore_terminal(nullptr);
  if (terminal_) tcsetattr(STDIN_FILENO, TCSANOW, &terminal_->before);
}

}  // namespace mbk::app
