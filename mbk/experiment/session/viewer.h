#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <string>
#include <thread>

#include "mbk/base/realtime/bounded_ring.h"
#include "mbk/files/journal/tick.h"

namespace mbk::session {

/// Called with ticks as they are recorded, in their order, from one thread that nothing in real time waits for.
using Watch = std::function<void(std::span<const journal::Tick>)>;

/// Hands ticks on to a watch from a thread of ordinary priority, without a lock in between: whoever shows them may be
/// slow, or be kept from running by others, and holds up no recording. A watch that throws is not called again.
class Viewer {
 public:
  /// When the watch lags behind by the whole ring.
  enum class Lagging {
    skips,      ///< ticks are left out, and counted
    is_waited,  ///< show() waits for it
  };

  Viewer(Watch watch, std::size_t capacity, Lagging lagging);
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer();

  /// By one thread.
  void show(std::span<const journal::Tick> ticks) noexcept;

  /// Returns when all that is to be shown has been.   @returns  what failed, or was left out; may be empty
  [[nodiscard]] std::string finish();

 private:
  void wake() noexcept;
  void hand_on() noexcept;
  void call(std::span<const journal::Tick> ticks) noexcept;
  void stop() noexcept;

  Watch watch_;
  Lagging lagging_;
  realtime::BoundedRing<journal::Tick> ring_;
  std::string failure_;  // of the viewer's thread until that is over
  std::atomic<bool> over_{false};
  std::atomic<int> came_{0};
  std::thread thread_;
};

}  // namespace mbk::session
