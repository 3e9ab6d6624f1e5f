#pragma once

#include <termios.h>

#include <array>
#include <csignal>
#include <cstddef>
#include <filesystem>

#include "mbk/base/realtime/signal_stack.h"
#include "mbk/experiment/device/device.h"

namespace mbk::app {

inline constexpr int kMotorsNotOff = 7;  ///< exit code: the robot did not confirm that its motors are off

/// While it lives, a signal that means the end of the program (a wild pointer, a division by zero, abort, and with it
/// an exception that nobody catches) first switches the robot's motors off, where the device can say so from there
/// (Device::emergency_off), and gives the terminal its keys back. Then it acts as it does without: core dump and exit
/// status stay. A driver that calls exit() does the same, and the program ends with kMotorsNotOff. Neither SIGKILL nor
/// a machine that stands still leaves time for it; the robot's watchdog does.
class LastWords {
 public:
  /// @param robot  outlives this    @param journal  of the trial, for those who come to look
  LastWords(device::Device& robot, const std::filesystem::path& journal);
  LastWords(const LastWords&) = delete;
  LastWords& operator=(const LastWords&) = delete;
  ~LastWords();

  /// What a fatal signal does first, for an end that is none. Nothing where nobody waits for one.
  static void say() noexcept;

  /// How standard input's terminal was; null: it is left as it is. Stays valid while it is set.
  static void restore_terminal(const termios* before);

 private:
  static constexpr std::size_t kFatal = 7;

  realtime::SignalStack stack_;  // of the thread that waits for the loop
  std::array<struct sigaction, kFatal> before_{};
};

}  // namespace mbk::app
