#include "mbk/base/core/ordinal.h"

#include <fmt/format.h>

namespace mbk {

std::string ordinal(std::int64_t n) {
  const bool teen = n % 100 / 10 == 1;
  const char* const ending = teen || n % 10 > 3 || n % 10 == 0 ? "th" : n % 10 == 1 ? "st" : n % 10 == 2 ? "nd" : "rd";
  return fmt::format("{}{}", n, ending);
}

}  // namespace mbk
