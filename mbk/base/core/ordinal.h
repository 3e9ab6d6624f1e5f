#pragma once

#include <cstdint>
#include <string>

namespace mbk {

/// "1st", "22nd", "113th".   @param n  ≥ 0
[[nodiscard]] std::string ordinal(std::int64_t n);

}  // namespace mbk
