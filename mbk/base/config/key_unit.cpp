#include "mbk/base/config/key_unit.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

namespace mbk::config {
namespace {

struct Named {
  std::string_view name;
  KeyUnit unit;
};

constexpr auto kUnits = std::to_array<Named>({
    {"m", {}},
    {"cm", {1.0, 1e2}},
    {"mm", {1.0, 1e3}},
    {"um", {1.0, 1e6}},
    {"rad", {}},
    {"mrad", {1.0, 1e3}},
    {"deg", {std::numbers::pi, 180.0}},
    {"s", {}},
    {"ms", {1.0, 1e3}},
    {"us", {1.0, 1e6}},
    {"Hz", {}},
    {"hz", {}},
    {"kHz", {1e3, 1.0}},
    {"khz", {1e3, 1.0}},
    {"kg", {}},
    {"g", {1.0, 1e3}},
    {"N", {}},
    {"kN", {1e3, 1.0}},
    {"mN", {1.0, 1e3}},
    {"Nm", {}},
    {"Nmm", {1.0, 1e3}},
    {"mNm", {1.0, 1e3}},
    {"Ns", {}},
    {"Nms", {}},
    {"V", {}},
    {"mV", {1.0, 1e3}},
    {"uV", {1.0, 1e6}},
    {"A", {}},
    {"mA", {1.0, 1e3}},
    {"percent", {1.0, 1e2}},
});

bool is_square(std::string_view word) {
  return word.ends_with('2');
}

std::optional<KeyUnit> find_unit(std::string_view word) {
  const bool square = is_square(word);
  if (square) word.remove_suffix(1);
  const auto named = std::ranges::find(kUnits, word, &Named::name);
  if (named == kUnits.end()) return std::nullopt;
  const KeyUnit& unit = named->unit;
  return square ? KeyUnit{unit.multiply * unit.multiply, unit.divide * unit.divide} : unit;
}

/// The last word of `key`, which loses it; empty where only one word is left.
std::string_view take_last_word(std::string_view& key) {
  const auto underscore = key.rfind('_');
  if (underscore == std::string_view::npos) return {};
  const std::string_view word = key.substr(underscore + 1);
  key = key.substr(0, underscore);
  return word;
}

/// The unit at the end of `key`: one word, or a factor and a square.
KeyUnit take_product(std::string_view key) {
  const std::string_view last = take_last_word(key);
  const std::optional<KeyUnit> unit = find_unit(last);
  if (!unit) return {};
  const std::optional<KeyUnit> factor = is_square(last) ? find_unit(take_last_word(key)) : std::nullopt;
  return factor ? KeyUnit{factor->multiply * unit->multiply, factor->divide * unit->divide} : *unit;
}

}  // namespace

KeyUnit unit_of_key(std::string_view key) {
  std::string_view rest = key;
  const std::string_view last = take_last_word(rest);
  std::string_view numerator = rest;
  if (take_last_word(numerator) != "per") return take_product(key);
  const KeyUnit above = take_product(numerator);
  const KeyUnit below = find_unit(last).value_or(KeyUnit{});
  return {above.multiply * below.divide, above.divide * below.multiply};
}

}  // namespace mbk::config
