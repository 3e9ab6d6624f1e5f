#include <algorithm>

#include "mbk/base/system/time.h"
#include "mbk/base/system/windows_api.h"

namespace mbk::system {

bool read_clock(std::int64_t& now) noexcept {
  constexpr std::int64_t kSecond = 1'000'000'000;
  LARGE_INTEGER rate{}, count{};
  if (QueryPerformanceFrequency(&rate) == 0 || QueryPerformanceCounter(&count) == 0) return false;
  const std::int64_t whole = count.QuadPart / rate.QuadPart, rest = count.QuadPart % rate.QuadPart;
  now = whole * kSecond + rest * kSecond / rate.QuadPart;
  return true;
}

bool sleep_until(std::int64_t then) noexcept {
  constexpr std::int64_t kMillisecond = 1'000'000;
  std::int64_t now = 0;
  if (!read_clock(now)) return false;
  Sleep(static_cast<DWORD>(std::clamp<std::int64_t>((then - now + kMillisecond - 1) / kMillisecond, 0, 1000)));
  return read_clock(now) && now >= then;
}

}  // namespace mbk::system
