#pragma once

#include <algorithm>
#include <chrono>
#include <thread>

namespace mbk::realtime {

/// Sleeps for `longest`, or until `done` returns true, which is called every 5 ms. It depends on no clock and holds no
/// mutex: if the clock cannot be read, a condition variable with a time limit never returns, nor releases its mutex.
/// @returns  done()
template <class Done>
bool rest(std::chrono::nanoseconds longest, const Done& done) {
  constexpr std::chrono::nanoseconds kSlice = std::chrono::milliseconds(5);
  for (auto left = longest; !done(); left -= kSlice) {
    if (left <= left.zero()) return false;
    std::this_thread::sleep_for(std::min(left, kSlice));
  }
  return true;
}

}  // namespace mbk::realtime
