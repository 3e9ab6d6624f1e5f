#pragma once

#include <atomic>
#include <cstdint>

namespace mbk::realtime {

/// What wakes a loop: ticks at absolute times, one period apart. Nothing allocates.
class Clock {
 public:
  virtual ~Clock() = default;

  /// The first tick is one period from now.
  virtual void start() noexcept = 0;

  /// Sleeps until the next tick. A tick that is already over is not made up for: the ticks go on from the first one
  /// that is still to come, and those between count as missed.
  /// @returns  by how much the wake-up is late, with the ticks that went by before it [s] ≥ 0
  virtual double wait() noexcept = 0;

  /// From one tick to the next [s].
  [[nodiscard]] virtual double period() const noexcept = 0;

  /// Since `start` [s].
  [[nodiscard]] virtual double now() const noexcept = 0;

  /// Ticks that went by without a wake-up.
  [[nodiscard]] virtual std::uint64_t missed() const noexcept = 0;

  /// Wake-ups before their time: the wait went on.
  [[nodiscard]] virtual std::uint64_t early() const noexcept { return 0; }

 protected:
  Clock() = default;
  Clock(const Clock&) = default;
  Clock(Clock&&) = default;
  Clock& operator=(const Clock&) = default;
  Clock& operator=(Clock&&) = default;
};

/// CLOCK_MONOTONIC with absolute wake-ups (clock_nanosleep), so that no tick drifts by what the one before it took.
class WallClock : public Clock {
 public:
  /// @param period  [s] > 0
  explicit WallClock(double period) noexcept;
  void start() noexcept override;
  double wait() noexcept override;
  [[nodiscard]] double period() const noexcept override { return 1e-9 * static_cast<double>(period_); }
  [[nodiscard]] double now() const noexcept override;
  [[nodiscard]] std::uint64_t missed() const noexcept override { return missed_; }
  [[nodiscard]] std::uint64_t early() const noexcept override { return early_; }

 private:
  std::int64_t period_, origin_ = 0, next_ = 0;  // [ns]
  std::uint64_t missed_ = 0, early_ = 0;
};

/// Virtual time, which each tick advances: the same loop runs as fast as possible. `speed` > 0 limits it to this
/// multiple of real time, so that it can be watched.
class VirtualClock : public Clock {
 public:
  /// @param period  [s] > 0
  explicit VirtualClock(double period, double speed = 0.0) noexcept;
  void start() noexcept override;
  double wait() noexcept override;
  [[nodiscard]] double period() const noexcept override { return period_; }
  [[nodiscard]] double now() const noexcept override;
  [[nodiscard]] std::uint64_t missed() const noexcept override { return missed_; }

  /// Delays the next tick by this number of periods, as a stalling computer would. From any thread.
  void stall(std::uint64_t periods) noexcept { stall_.store(periods, std::memory_order_relaxed); }

 private:
  double period_, speed_;
  std::uint64_t tick_ = 0, missed_ = 0;
  std::atomic<std::uint64_t> stall_{0};
  WallClock pace_;
};

/// Monotonic time [ns], for durations.
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

}  // namespace mbk::realtime
