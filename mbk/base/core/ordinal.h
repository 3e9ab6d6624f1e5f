#pragma once

#include <string>

namespace mbk {

/// "1st", "22nd", "113th".   @param n  ≥ 0
[[nodiscard]] std::string ordinal(long n);

}  // namespace mbk
