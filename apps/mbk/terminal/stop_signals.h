#pragma once

#include <array>
#include <csignal>
#include <cstddef>

#include "mbk/experiment/session/loop.h"

namespace mbk::app {

/// During its lifetime no catchable signal suspends or ends the program directly: Ctrl-C, Ctrl-\, Ctrl-Z, SIGTERM,
/// SIGHUP (terminal closed, unless ignored by nohup), and the others whose default action ends a program. During a
/// trial each is a stop by the operator. All but Ctrl-C during a trial also end the session (LoopFlags::end_session). A
/// second one outside of a trial ends the program at once; so does a second one during a trial whose loop does not
/// return from the robot (LoopFlags::silent), with kMotorsNotOff.
class StopSignals {
 public:
  /// @param flags  of the session; outlives this
  explicit StopSignals(session::LoopFlags& flags);
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals();

  /// The signal that ended the session; 0: none.
  [[nodiscard]] int ended_by() const;

  /// A trial is running during its lifetime.
  class Trial {
   public:
    Trial();
    Trial(const Trial&) = delete;
    Trial& operator=(const Trial&) = delete;
    ~Trial();
  };

 private:
  static constexpr std::size_t kEnding = 11, kHeld = 2;
  std::array<struct sigaction, kEnding + kHeld> before_{};
};

/// Ends the program as the uncaught signal would, so that shells and supervisors see the cause.
[[noreturn]] void end_by(int signal);

}  // namespace mbk::app
