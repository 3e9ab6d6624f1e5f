#include "mbk/base/core/option_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace mbk {
namespace {

constexpr double kLargest = 1e12;

/// The number in a text; nothing if the text is not a number as a whole.
template <class Number>
std::optional<Number> number(const std::string& given) {
  Number value{};
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), value);
  if (error != std::errc() || end != given.data() + given.size()) return std::nullopt;
  return value;
}

}  // namespace

std::string quoted(const std::string& given) {
  constexpr std::size_t kShown = 24;
  return given.size() > kShown ? fmt::format("'{}…'", given.substr(0, kShown)) : fmt::format("'{}'", given);
}

OptionCheck positive() {
  return {[](const std::string& given) -> std::string {
    const auto value = number<double>(given);
    return value && *value > 0.0 && *value < kLargest ? "" : fmt::format("{} is not a positive number", quoted(given));
  }};
}

OptionCheck not_negative() {
  return {[](const std::string& given) -> std::string {
    const auto value = number<double>(given);
    return value && *value >= 0.0 && *value < kLargest
               ? ""
               : fmt::format("{} is neither zero nor a positive number", quoted(given));
  }};
}

OptionCheck number_within(double largest) {
  return {[=](const std::string& given) -> std::string {
    const auto value = number<double>(given);
    return value && *value >= -largest && *value <= largest
               ? ""
               : fmt::format("{} is not a number from {:g} to {:g}", quoted(given), -largest, largest);
  }};
}

OptionCheck whole_number(std::int64_t least, std::int64_t most) {
  return {[=](const std::string& given) -> std::string {
    const auto value = number<std::int64_t>(given);
    return value && *value >= least && *value <= most
               ? ""
               : fmt::format("{} is not a whole number from {} to {}", quoted(given), least, most);
  }};
}

OptionCheck odd_number(std::int64_t least, std::int64_t most) {
  return {[=](const std::string& given) -> std::string {
    const auto value = number<std::int64_t>(given);
    return value && *value >= least && *value <= most && *value % 2 == 1
               ? ""
               : fmt::format("{} is not an odd number from {} to {}", quoted(given), least, most);
  }};
}

OptionCheck not_empty() {
  return {[](const std::string& given) -> std::string { return given.empty() ? "'' is empty" : ""; }};
}

OptionCheck one_of(const std::vector<std::string>& words) {
  return {[words](const std::string& given) -> std::string {
            if (std::ranges::find(words, given) != words.end()) return "";
            return fmt::format("{} is not one of {}", quoted(given), fmt::join(words, "|"));
          },
          words};
}

OptionCheck suggests(const std::vector<std::string>& words) {
  return {{}, words};
}

}  // namespace mbk
