#pragma once

#include <array>
#include <csignal>
#include <cstddef>

#include "mbk/experiment/session/loop.h"

namespace mbk::app {

/// While it lives, no signal that can be caught suspends the program or ends it by itself: Ctrl-C, Ctrl-\, Ctrl-Z, a
/// request to end (SIGTERM), a terminal that is closed (SIGHUP, unless nohup has it ignored), and the others that end
/// programs that do not expect them. Within a trial each is a stop by the operator. All but Ctrl-C within a trial also
/// end the session (LoopFlags::end_session); a second one outside of a trial ends the program at once, as does a second
/// one within a trial whose loop does not come back from the robot (LoopFlags::silent), with kMotorsNotOff.
class StopSignals {
 public:
  /// @param flags  of the session; outlives this
  explicit StopSignals(session::LoopFlags& flags);
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals();

  /// The signal that ended the session; 0: none.
  [[nodiscard]] int ended_by() const;

  /// A trial goes on while it lives.
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

/// Ends the program as the signal ends one that does not catch it, so that shells and supervisors see what it was.
[[noreturn]] void end_by(int signal);

}  // namespace mbk::app
