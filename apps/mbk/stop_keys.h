#pragma once

#include <csignal>
#include <memory>
#include <optional>
#include <thread>

#include "mbk/session/loop.h"

namespace mbk::app {

/// While it lives, Ctrl-C and a request to end (SIGTERM) stop the robot instead of the program; and at a terminal so
/// does the space bar, and e ends the trial early.
class StopKeys {
 public:
  explicit StopKeys(session::Signals& signals);
  StopKeys(const StopKeys&) = delete;
  StopKeys& operator=(const StopKeys&) = delete;
  ~StopKeys();

 private:
  struct Terminal;
  void watch(session::Signals& signals, std::stop_token over) const;

  struct sigaction interrupt_before_ {};
  struct sigaction end_before_ {};
  std::unique_ptr<Terminal> terminal_;  // as it was; null where standard input is none
  std::optional<std::jthread> watching_;
};

}  // namespace mbk::app
