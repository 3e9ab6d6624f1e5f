#pragma once

#include <functional>
#include <span>
#include <string>
#include <thread>

#include "mbk/base/realtime/bounded_ring.h"
#include "mbk/base/realtime/wake_up.h"
#include "mbk/files/journal/tick.h"

namespace mbk::session {

/// Called with ticks as they are recorded, in their order, by one thread at a time.
using Watch = std::function<void(std::span<const journal::Tick>)>;

/// Shows ticks to a watch. A watch that throws is not called again.
class Viewer {
 public:
  enum class Pace {
    waits,  ///< show() calls the watch
    skips,  ///< a thread of ordinary priority calls it, without a lock in between: whoever shows ticks may be slow, or
            ///< be kept from running by others, and holds nobody up; what it lags behind by more than the ring is left
            ///< out
  };

  /// @param room  ticks that the ring holds
  Viewer(Watch watch, std::size_t room, Pace pace);
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer();

  /// By one thread at a time.
  void show(std::span<const journal::Tick> ticks) noexcept;

  /// Returns when all that is to be shown has been.   @returns  what failed, or was left out; may be empty
  [[nodiscard]] std::string finish();

 private:
  void hand_on() noexcept;
  void call(std::span<const journal::Tick> ticks) noexcept;
  void stop() noexcept;

  Watch watch_;
  realtime::BoundedRing<journal::Tick> ring_;
  std::string failure_;  // of the thread that calls the watch, until that is over
  realtime::WakeUp wake_up_;
  std::thread thread_;
};

}  // namespace mbk::session
