#include "apps/mbk/option_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>
#include <string_view>

namespace mbk::app {
namespace {

constexpr double kLargest = 1e12;
constexpr std::string_view kSuggestions = "suggestions";  ///< the name of a validator begins so where words follow

/// The number that the whole text is; nothing where it is none.
template <class Number>
std::optional<Number> number(const std::string& given) {
  Number value{};
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), value);
  if (error != std::errc() || end != given.data() + given.size()) return std::nullopt;
  return value;
}

std::string name_with(const std::vector<std::string>& words) {
  return fmt::format("{} {}", kSuggestions, fmt::join(words, " "));
}

}  // namespace

std::string quoted(const std::string& given) {
  constexpr std::size_t kShown = 24;
  return given.size() > kShown ? fmt::format("'{}…'", given.substr(0, kShown)) : fmt::format("'{}'", given);
}

CLI::Validator positive() {
  return {[](const std::string& given) -> std::string {
            const auto value = number<double>(given);
            return value && *value > 0.0 && *value < kLargest
                       ? ""
                       : fmt::format("{} is not a positive number", quoted(given));
          },
          ""};
}

CLI::Validator not_negative() {
  return {[](const std::string& given) -> std::string {
            const auto value = number<double>(given);
            return value && *value >= 0.0 && *value < kLargest
                       ? ""
                       : fmt::format("{} is neither zero nor a positive number", quoted(given));
          },
          ""};
}

CLI::Validator number_within(double largest) {
  return {[=](const std::string& given) -> std::string {
            const auto value = number<double>(given);
            return value && *value >= -largest && *value <= largest
                       ? ""
                       : fmt::format("{} is not a number from {:g} to {:g}", quoted(given), -largest, largest);
          },
          ""};
}

CLI::Validator whole_number(long least, long most) {
  return {[=](const std::string& given) -> std::string {
            const auto value = number<long>(given);
            return value && *value >= least && *value <= most
                       ? ""
                       : fmt::format("{} is not a whole number from {} to {}", quoted(given), least, most);
          },
          ""};
}

CLI::Validator odd_number(long least, long most) {
  return {[=](const std::string& given) -> std::string {
            const auto value = number<long>(given);
            return value && *value >= least && *value <= most && *value % 2 == 1
                       ? ""
                       : fmt::format("{} is not an odd number from {} to {}", quoted(given), least, most);
          },
          ""};
}

CLI::Validator not_empty() {
  return {[](const std::string& given) -> std::string { return given.empty() ? "'' is empty" : ""; }, ""};
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  return {[words](const std::string& given) -> std::string {
            if (std::ranges::find(words, given) != words.end()) return "";
            return fmt::format("{} is none of {}", quoted(given), fmt::join(words, "|"));
          },
          "", name_with(words)};
}

CLI::Validator suggests(const std::vector<std::string>& words) {
  return CLI::Validator().name(name_with(words));
}

std::vector<std::string> suggestions(CLI::Option& option) {
  std::vector<std::string> words;
  for (int i = 0;; ++i) {
    try {
      std::istringstream name(option.get_validator(i)->get_name());
      std::string word;
      if (!(name >> word) || word != kSuggestions) continue;
      while (name >> word) words.push_back(word);
    } catch (const CLI::OptionNotFound&) {
      return words;  // that was the last one
    }
  }
}

void accept_former_name(CLI::App& command, CLI::Option& option, const std::string& former) {
  command
      .add_option_function<std::vector<std::string>>(former,
                                                     [&option](const std::vector<std::string>& given) {
                                                       for (const std::string& value : given) option.add_result(value);
                                                       option.run_callback();
                                                     })
      ->expected(option.get_expected_min(), option.get_expected_max())
      ->group("");
}

}  // namespace mbk::app
