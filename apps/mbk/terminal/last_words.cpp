#include "apps/mbk/terminal/last_words.h"

#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <string>

namespace mbk::app {
namespace {

std::atomic<device::Device*> robot_at_work{nullptr};
std::atomic<const termios*> terminal_before{nullptr};
std::atomic<const struct sigaction*> actions_before{nullptr};
static_assert(std::atomic<device::Device*>::is_always_lock_free);

constexpr std::array kFatalSignals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP};

/// Only what POSIX allows in a handler (signal-safety(7)).
extern "C" void on_fatal_signal(int signal) {
  LastWords::say();
  const struct sigaction* const actions = actions_before;
  for (std::size_t i = 0; actions != nullptr && i < kFatalSignals.size(); ++i) {
    if (kFatalSignals[i] == signal) sigaction(signal, &actions[i], nullptr);
  }
  raise(signal);  // taken once this handler is left
}

/// Constructed before the handler that reads it is registered, so that it outlives the handler.
std::string& journal_at_work() {
  static std::string journal;
  return journal;
}

/// exit() was called during a trial: by a driver, since mbk never does.
void on_exit_in_trial() {
  if (robot_at_work == nullptr) return;
  LastWords::say();
  const std::string what =
      "\a\nmbk: MOTORS NOT CONFIRMED OFF: the robot's driver ended the program. Press the hardware stop button. "
      "Recover the data with: mbk recover " +
      journal_at_work() + "\n";
  static_cast<void>(!::write(STDERR_FILENO, what.data(), what.size()));
  std::_Exit(kMotorsNotOff);
}

}  // namespace

/// What signals did before.
struct LastWords::Before {
  std::array<struct sigaction, kFatalSignals.size()> actions{};
};

LastWords::LastWords(device::Device& robot, const std::filesystem::path& journal)
    : before_(std::make_unique<Before>()) {
  journal_at_work() = journal.string();
  static const int kRegistered = std::atexit(on_exit_in_trial);
  static_cast<void>(kRegistered);
  robot_at_work = &robot;
  struct sigaction action {};
  action.sa_handler = on_fatal_signal;
  action.sa_flags = SA_ONSTACK;
  for (std::size_t i = 0; i < kFatalSignals.size(); ++i) {
    sigaction(kFatalSignals[i], &action, &before_->actions[i]);
  }
  actions_before = before_->actions.data();
}

LastWords::~LastWords() {
  for (std::size_t i = 0; i < kFatalSignals.size(); ++i) {
    sigaction(kFatalSignals[i], &before_->actions[i], nullptr);
  }
  actions_before = nullptr;
  robot_at_work = nullptr;
}

void LastWords::say() noexcept {
  if (device::Device* const robot = robot_at_work.exchange(nullptr)) robot->emergency_off();
  if (const termios* const before = terminal_before) tcsetattr(STDIN_FILENO, TCSANOW, before);
}

void LastWords::restore_terminal(const termios* before) {
  terminal_before = before;
}

}  // namespace mbk::app
