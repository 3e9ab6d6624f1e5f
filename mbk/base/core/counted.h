#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

namespace mbk {

/// "3 recordings", "1 recording".
[[nodiscard]] inline std::string counted(std::int64_t n, const char* one, const char* more) {
  return fmt::format("{} {}", n, n == 1 ? one : more);
}

}  // namespace mbk
