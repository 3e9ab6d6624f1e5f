#include "mbk/base/core/option_table.h"

#include <cmath>

#include "mbk/base/core/printable.h"

namespace mbk {

std::string canonical_text(const std::string& value) {
  const std::string_view digits = std::string_view(value).substr(value.starts_with('+') ? 1 : 0);
  double number = 0.0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool whole = code == std::errc() && end == digits.data() + digits.size() && std::isfinite(number);
  return whole ? fmt::format("{}", number) : value;
}

std::string typed_text(const OptionTexts& given) {
  std::vector<std::string> words;
  for (const auto& [name, values] : given) {
    if (values.empty()) words.push_back(name);
    for (const std::string& value : values) words.push_back(name + ' ' + value);
  }
  return printable(fmt::format("{}", fmt::join(words, " ")));
}

}  // namespace mbk
