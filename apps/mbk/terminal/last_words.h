#pragma once

#include <filesystem>
#include <memory>

#include "mbk/base/realtime/signal_stack.h"
#include "mbk/experiment/device/device.h"

struct termios;

namespace mbk::app {

inline constexpr int kMotorsNotOff = 7;  ///< exit code: the robot did not confirm that its motors are off

/// During its lifetime a fatal signal (an invalid pointer, a division by zero, abort, and with it an uncaught
/// exception) first switches the robot's motors off, if the device can do so from a signal handler
/// (Device::emergency_off), and restores the terminal. Then the signal acts as usual: core dump and exit status are
/// unchanged. A driver that calls exit() has the same effect, and the program ends with kMotorsNotOff. SIGKILL and a
/// frozen computer leave no time for this; the robot's watchdog covers them.
class LastWords {
 public:
  /// @param robot  outlives this    @param journal  of the trial, named in the alarm
  LastWords(device::Device& robot, const std::filesystem::path& journal);
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;
  ~LastWords();

  /// What a fatal signal does first, for other abrupt ends. Does nothing if no LastWords exists.
  static void say() noexcept;

  /// The settings of the terminal to restore; null: none. Stays valid while it is set.
  static void restore_terminal(const termios* before);

 private:
  struct Before;

  realtime::SignalStack stack_;  // of the thread that waits for the loop
  std::unique_ptr<Before> before_;
};

}  // namespace mbk::app
