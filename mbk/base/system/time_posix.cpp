#include <cerrno>
#include <ctime>

#include "mbk/base/system/time.h"

namespace mbk::system {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

}  // namespace

bool read_clock(std::int64_t& now) noexcept {
  timespec time{};
  if (clock_gettime(CLOCK_MONOTONIC, &time) != 0) return false;
  now = std::int64_t{time.tv_sec} * kSecond + time.tv_nsec;
  return true;
}

bool sleep_until(std::int64_t then) noexcept {
  const timespec until{then / kSecond, then % kSecond};
  return clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) != EINTR;
}

}  // namespace mbk::system
