#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

namespace mbk {

/// `value` to that many significant digits, without an exponent below 10⁵: 628.3 is "630" with two.
[[nodiscard]] inline std::string significant(double value, int digits) {
  std::string text = fmt::format("{:.{}g}", value, digits);
  if (!(std::abs(value) < 1e5) || text.find("e+") == std::string::npos) return text;
  double rounded = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return fmt::format("{:.0f}", rounded);
}

}  // namespace mbk
