#include "apps/mbk/stop_keys.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <memory>

namespace mbk::app {
namespace {

/// Where a signal goes while a trial runs.
std::atomic<session::Signals*> running{nullptr};

extern "C" void on_signal(int /*signal*/) {
  if (session::Signals* signals = running.load()) signals->operator_stop = true;
}

}  // namespace

struct StopKeys::Terminal {
  termios before{};
};

StopKeys::StopKeys(session::Signals& signals) {
  running = &signals;
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, &interrupt_before_);
  sigaction(SIGTERM, &action, &end_before_);
  // only in the foreground: a program behind the shell would be stopped by its terminal
  if (isatty(STDIN_FILENO) != 1 || tcgetpgrp(STDIN_FILENO) != getpgrp()) return;
  terminal_ = std::make_unique<Terminal>();
  tcgetattr(STDIN_FILENO, &terminal_->before);
  termios keys = terminal_->before;
  keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(STDIN_FILENO, TCSANOW, &keys);
  watching_.emplace([this, &signals](const std::stop_token& over) { watch(signals, over); });
}

void StopKeys::watch(session::Signals& signals, std::stop_token over) const {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!over.stop_requested()) {
    constexpr int kWait = 20;  // [ms]
    if (poll(&input, 1, kWait) <= 0) continue;
    char key = 0;
    if (read(STDIN_FILENO, &key, 1) != 1) return;
    if (key == ' ') signals.operator_stop = true;
    if (key == 'e') signals.end_trial = true;
  }
}

StopKeys::~StopKeys() {
  watching_.reset();
  if (terminal_) tcsetattr(STDIN_FILENO, TCSANOW, &terminal_->before);
  sigaction(SIGINT, &interrupt_before_, nullptr);
  sigaction(SIGTERM, &end_before_, nullptr);
  running = nullptr;
}

}  // namespace mbk::app
