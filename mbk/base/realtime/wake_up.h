#pragma once

#include <atomic>

namespace mbk::realtime {

/// Wakes one thread without a lock, so that who asks never waits for it. What is asked, as bits, adds up until it
/// looks.
class WakeUp {
 public:
  void ask(int what) noexcept {
    asked_ |= what;
    asked_.notify_one();
  }

  /// By the thread that is asked: waits until it is, and takes all that it is asked.
  [[nodiscard]] int wait() noexcept {
    asked_.wait(0);
    return asked_.exchange(0);
  }

 private:
  std::atomic<int> asked_{0};
};

}  // namespace mbk::realtime
