#pragma once

#include <cstdint>

namespace mbk::system {

/// A clock that nobody sets [ns].   @returns  false: it cannot be read, and `now` is unchanged
[[nodiscard]] bool read_clock(std::int64_t& now) noexcept;

/// Sleeps until that clock shows `then` [ns].   @returns  false: something woke it before
bool sleep_until(std::int64_t then) noexcept;

}  // namespace mbk::system
