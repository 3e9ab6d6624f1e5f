#pragma once

#include <atomic>
#include <cstdint>

#include "mbk/base/realtime/bounded_ring.h"
#include "mbk/base/realtime/clock.h"
#include "mbk/base/realtime/cycle_record.h"
#include "mbk/experiment/control/sequencer.h"
#include "mbk/experiment/device/device.h"
#include "mbk/experiment/safety/gate.h"
#include "mbk/files/journal/tick.h"

namespace mbk::session {

/// What other threads tell the loop, and it them.
struct LoopFlags {
  std::atomic<bool> operator_stop{false};  ///< safety stop by key or console
  std::atomic<int> stop_signal{0};         ///< the signal that asked for it; 0: a person did
  std::atomic<bool> end_trial{false};      ///< end the perturbation early, and go back
  std::atomic<bool> end_session{false};    ///< the program must end: no more questions, no more trials
  std::atomic<bool> recording{true};       ///< what is recorded reaches its file
  std::atomic<bool> silent{false};         ///< the loop has not ticked for a while (LoopWatch)

  static constexpr std::uint64_t kGivenUp = ~std::uint64_t{0};
  std::atomic<std::uint64_t> beats{0};  ///< how often the loop came back from the robot; kGivenUp: nobody waits for it

  /// By the loop, wherever it comes back from the robot: what it did until then is seen by whoever reads `beats`.
  /// @returns  false where it was given up: it touches nothing any more
  [[nodiscard]] bool beat() noexcept {
    std::uint64_t last = beats.load(std::memory_order_relaxed);
    return last != kGivenUp && beats.compare_exchange_strong(last, last + 1, std::memory_order_acq_rel);
  }
  [[nodiscard]] bool given_up() const noexcept { return beats.load(std::memory_order_acquire) == kGivenUp; }
};

/// What the loop says of its own time.
struct LoopTimes {
  realtime::CycleRecord compute;   ///< from the wake-up to the command's end
  realtime::CycleRecord lateness;  ///< of the wake-up
  realtime::CycleRecord interval;  ///< from one command that left to the next
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;  ///< ticks that went by without a wake-up
  std::uint64_t early = 0;   ///< wake-ups before their time, which the loop waited on from
};

/// Runs a trial from the first tick to the last: wait, read the robot, decide, pass the gate, write the robot, hand the
/// tick over. Where the sequence is done, or a trip's ramp is over, it goes on with motors off until the robot has
/// confirmed that, or has not within Limits::motors_off (Gate::motors). Nothing in it allocates, locks, prints or
/// touches a file. Where LoopFlags::beat says that it was given up, it stops the robot and ends. A robot that waits for
/// its commands (Facts::keeps_time) is made to wait for a recorder that lags, up to two seconds; any other is not, and
/// a lagging recorder trips the gate.
void run_loop(device::Device& robot, control::Sequencer& sequence, safety::Gate& gate, realtime::Clock& clock,
              realtime::BoundedRing<journal::Tick>& ticks, LoopFlags& flags, LoopTimes& times) noexcept;

}  // namespace mbk::session
