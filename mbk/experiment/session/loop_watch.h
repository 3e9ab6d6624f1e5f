#pragma once

#include <functional>
#include <thread>

#include "mbk/experiment/session/loop.h"

namespace mbk::session {

/// Watches from a thread of its own whether a loop still ticks: a robot's driver that never returns takes the gate, the
/// stop button and every key with it. It counts its own wake-ups, 20 ms apart, so that a machine that stands still as a
/// whole is not taken for a driver that does.
class LoopWatch {
 public:
  static constexpr double kLongest = 0.1;  ///< without a tick [s]

  struct Told {
    std::function<void(double silent_s)> silent;  ///< no tick for 100 ms
    std::function<void(double silent_s)> again;   ///< it ticks again
    /// It is given up: somebody asked for a stop, or nothing came for a second. The loop ends itself where it returns.
    std::function<void(double silent_s)> given_up;
  };

  /// @param by_itself  gives up without being asked; false: the robot waits for commands, and stands still meanwhile
  LoopWatch(LoopFlags& flags, bool by_itself, Told told);
  LoopWatch(const LoopWatch&) = delete;
  LoopWatch& operator=(const LoopWatch&) = delete;
  ~LoopWatch();

 private:
  void watch() noexcept;

  LoopFlags& flags_;
  bool by_itself_;
  Told told_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

}  // namespace mbk::session
