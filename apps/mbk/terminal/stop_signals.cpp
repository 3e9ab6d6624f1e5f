#include "apps/mbk/terminal/stop_signals.h"

#include <atomic>
#include <cstdlib>

#include "apps/mbk/terminal/last_words.h"

namespace mbk::app {
namespace {

constexpr std::array kEndingSignals = {SIGINT,  SIGTERM, SIGHUP,  SIGQUIT, SIGTSTP, SIGUSR1,
                                       SIGUSR2, SIGALRM, SIGPOLL, SIGPWR,  SIGXCPU};
/// A program in the background that reads from its terminal or writes to it would be suspended.
constexpr std::array kHeldSignals = {SIGTTIN, SIGTTOU};

std::atomic<session::LoopFlags*> told{nullptr};
std::atomic<bool> in_trial{false};
std::atomic<int> ending_signal{0};        // by this signal
std::atomic<bool> came_outside{false};    // of a trial
std::atomic<bool> stopped_silent{false};  // in a trial whose loop does not come back
static_assert(std::atomic<session::LoopFlags*>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void act(int signal, void (*handler)(int), struct sigaction* before) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, before);
}

extern "C" void on_stop_signal(int signal) {
  session::LoopFlags* const flags = told;
  if (flags == nullptr) return;
  // A trial that begins now either sees end_session, or is seen here.
  if (signal != SIGINT || !in_trial) {
    int none = 0;
    ending_signal.compare_exchange_strong(none, signal);
    flags->end_session = true;
  }
  if (in_trial) {
    // The loop does not return although a signal has already requested its end: an orderly end is impossible.
    if (flags->silent && stopped_silent.exchange(true)) {
      LastWords::say();
      std::_Exit(kMotorsNotOff);
    }
    if (signal != SIGINT && !flags->operator_stop) flags->stop_signal = signal;
    flags->operator_stop = true;
  } else if (came_outside.exchange(true) && signal != SIGHUP) {
    act(signal, SIG_DFL, nullptr);  // requested twice; a closed terminal sends two signals
    std::raise(signal);
  }
}

}  // namespace

StopSignals::StopSignals(session::LoopFlags& flags) {
  static_assert(kEndingSignals.size() == kEnding && kHeldSignals.size() == kHeld);
  told = &flags;
  ending_signal = 0;
  came_outside = false;
  stopped_silent = false;
  std::size_t i = 0;
  for (const int signal : kEndingSignals) {
    act(signal, on_stop_signal, &before_[i]);
    if (signal == SIGHUP && before_[i].sa_handler == SIG_IGN) act(signal, SIG_IGN, nullptr);  // nohup
    ++i;
  }
  for (const int signal : kHeldSignals) act(signal, SIG_IGN, &before_[i++]);
}

StopSignals::~StopSignals() {
  std::size_t i = 0;
  for (const int signal : kEndingSignals) sigaction(signal, &before_[i++], nullptr);
  for (const int signal : kHeldSignals) sigaction(signal, &before_[i++], nullptr);
  told = nullptr;
}

int StopSignals::ended_by() const {
  return ending_signal;
}

StopSignals::Trial::Trial() {
  in_trial = true;
}

StopSignals::Trial::~Trial() {
  in_trial = false;
}

void end_by(int signal) {
  // neither a core nor a suspended program: it has ending_signal in order
  if (signal == SIGTSTP || signal == SIGQUIT || signal == SIGXCPU) signal = SIGTERM;
  act(signal, SIG_DFL, nullptr);
  std::raise(signal);
  std::_Exit(128 + signal);
}

}  // namespace mbk::app
