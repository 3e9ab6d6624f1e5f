#pragma once

#include <memory>
#include <optional>
#include <thread>

#include "mbk/experiment/session/loop.h"

namespace mbk::app {

/// During its lifetime, at a terminal: the space bar stops the robot, e ends the trial early, and closing the terminal
/// stops the robot and ends the session.
class StopKeys {
 public:
  explicit StopKeys(session::LoopFlags& flags);
  StopKeys(const StopKeys&) = delete;
  StopKeys& operator=(const StopKeys&) = delete;
  ~StopKeys();

 private:
  struct Terminal;
  static void watch(session::LoopFlags& flags, const std::stop_token& over) noexcept;

  std::unique_ptr<Terminal> terminal_;  // as it was; null where standard input is none
  std::optional<std::jthread> watching_;
};

}  // namespace mbk::app
