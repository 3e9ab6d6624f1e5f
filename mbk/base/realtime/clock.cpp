#include "mbk/base/realtime/clock.h"

#include <cmath>

#include "mbk/base/system/time.h"

namespace mbk::realtime {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t nanoseconds(double seconds) noexcept {
  return std::llround(seconds * static_cast<double>(kSecond));
}

}  // namespace

std::int64_t monotonic_ns() noexcept {
  // A clock that cannot be read stands still for that moment: at zero every deadline would be over, or never come.
  thread_local std::int64_t last = 0;
  static_cast<void>(system::read_clock(last));
  return last;
}

WallClock::WallClock(double period) noexcept : period_(nanoseconds(period)) {}

void WallClock::start() noexcept {
  origin_ = monotonic_ns();
  next_ = origin_ + period_;
  missed_ = early_ = 0;
}

double WallClock::wait() noexcept {
  const std::int64_t due = next_;
  if (const std::int64_t behind = monotonic_ns() - next_; behind >= period_) {
    const std::int64_t over = behind / period_;
    missed_ += static_cast<std::uint64_t>(over);
    next_ += over * period_;
  }
  std::int64_t woken = 0;
  while (true) {  // a sleep that returns at once must not make time run faster
    const bool slept = system::sleep_until(next_);
    woken = monotonic_ns();
    if (woken >= next_) break;
    if (slept) ++early_;
  }
  const std::int64_t late = woken - due;  // also of the ticks that went by
  next_ += period_;
  return static_cast<double>(late) / static_cast<double>(kSecond);
}

double WallClock::now() const noexcept {
  return static_cast<double>(monotonic_ns() - origin_) / static_cast<double>(kSecond);
}

VirtualClock::VirtualClock(double period, double speed) noexcept
    : period_(period), speed_(speed), pace_(speed > 0.0 ? period / speed : period) {}

void VirtualClock::start() noexcept {
  tick_ = 0;
  missed_ = 0;
  pace_.start();
}

double VirtualClock::wait() noexcept {
  if (speed_ > 0.0) pace_.wait();
  const std::uint64_t stalled = stall_.exchange(0, std::memory_order_relaxed);
  missed_ += stalled;
  tick_ += stalled + 1;
  return static_cast<double>(stalled) * period_;
}

double VirtualClock::now() const noexcept {
  return static_cast<double>(tick_) * period_;
}

}  // namespace mbk::realtime
