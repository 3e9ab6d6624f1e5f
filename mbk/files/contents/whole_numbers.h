#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "mbk/base/core/rests.h"

namespace mbk::recording {

/// The note on whole numbers that a double cannot represent.
[[nodiscard]] inline std::string rounded_note(std::string_view name) {
  return "'" + std::string(name) + "' contains integers above 2^53, which were rounded";
}

/// The whole number of which a double and a rest are known, digit by digit; a double above 2^64 as it is.
[[nodiscard]] inline std::string whole_text(double value, std::int16_t rest) {
  constexpr double kLargest = 0x1p64;
  if (!(value > -kLargest / 2 && value < kLargest)) return fmt::format("{:.0f}", value);
  if (value < 0.0) return fmt::format("{}", static_cast<std::int64_t>(value) + rest);
  return fmt::format("{}", static_cast<std::uint64_t>(value) + static_cast<std::uint64_t>(rest));
}

}  // namespace mbk::recording
