#include "mbk/base/core/natural_order.h"

#include <algorithm>

namespace mbk {

bool in_natural_order(std::string_view a, std::string_view b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  while (!a.empty() && !b.empty()) {
    if (digit(a.front()) && digit(b.front())) {
      const auto number = [&](std::string_view& text) {
        text.remove_prefix(std::min(text.find_first_not_of('0'), text.size()));
        const std::size_t end = static_cast<std::size_t>(std::ranges::find_if_not(text, digit) - text.begin());
        const std::string_view found = text.substr(0, end);
        text.remove_prefix(end);
        return found;
      };
      const std::string_view one = number(a), other = number(b);
      if (one.size() != other.size()) return one.size() < other.size();
      if (one != other) return one < other;
      continue;
    }
    if (a.front() != b.front()) return a.front() < b.front();
    a.remove_prefix(1);
    b.remove_prefix(1);
  }
  return a.size() < b.size();
}

}  // namespace mbk
