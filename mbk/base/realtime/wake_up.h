#pragma once

#include <atomic>

namespace mbk::realtime {

/// Wakes one thread without a lock, so that the caller never blocks. Requests are bits, which accumulate until the
/// thread takes them.
class WakeUp {
 public:
  void ask(int what) noexcept {
    asked_ |= what;
    asked_.notify_one();
  }

  /// For the thread that is woken: waits for requests, and takes all of them.
  [[nodiscard]] int wait() noexcept {
    asked_.wait(0);
    return asked_.exchange(0);
  }

 private:
  std::atomic<int> asked_{0};
};

}  // namespace mbk::realtime
