#include "mbk/files/recording/si_units.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

namespace mbk::recording {
namespace {

using enum Dimension;
constexpr double kPi = std::numbers::pi;

/// The first unit of each dimension is its SI unit.
constexpr auto kUnits = std::to_array<Unit>({
    {"s", time, 1, 1},
    {"ms", time, 1, 1e3},
    {"us", time, 1, 1e6},
    {"ns", time, 1, 1e9},
    {"min", time, 60, 1},
    {"h", time, 3600, 1},
    {"day", time, 86400, 1},
    {"m", length, 1, 1},
    {"cm", length, 1, 1e2},
    {"mm", length, 1, 1e3},
    {"um", length, 1, 1e6},
    {"in", length, 0.0254, 1},
    {"rad", angle, 1, 1},
    {"mrad", angle, 1, 1e3},
    {"deg", angle, kPi, 180},
    {"°", angle, kPi, 180},
    {"N", force, 1, 1},
    {"kN", force, 1e3, 1},
    {"mN", force, 1, 1e3},
    {"lbf", force, 4.4482216152605, 1},
    {"kgf", force, 9.80665, 1},
    {"N.m", torque, 1, 1},
    {"Nm", torque, 1, 1},
    {"N*m", torque, 1, 1},
    {"N.mm", torque, 1, 1e3},
    {"Nmm", torque, 1, 1e3},
    {"mNm", torque, 1, 1e3},
    {"m/s2", acceleration, 1, 1},
    {"m/s^2", acceleration, 1, 1},
    {"mm/s2", acceleration, 1, 1e3},
    {"mm/s^2", acceleration, 1, 1e3},
    {"g", acceleration, 9.80665, 1},
    {"rad/s2", angular_acceleration, 1, 1},
    {"rad/s^2", angular_acceleration, 1, 1},
    {"deg/s2", angular_acceleration, kPi, 180},
    {"deg/s^2", angular_acceleration, kPi, 180},
    {"V", voltage, 1, 1},
    {"mV", voltage, 1, 1e3},
    {"uV", voltage, 1, 1e6},
});

/// "us" of "µs", "N.m" of "N·m", "m/s2" of "m/s²": signs for which there are letters.
std::string in_ascii(std::string_view name) {
  constexpr auto kSigns = std::to_array<std::pair<std::string_view, char>>(
      {{"\u00B5", 'u'}, {"\u03BC", 'u'}, {"\u00B7", '.'}, {"\u22C5", '.'}, {"\u00B2", '2'}, {"\xB5", 'u'}});
  std::string plain;
  while (!name.empty()) {
    const auto sign = std::ranges::find_if(kSigns, [name](const auto& one) { return name.starts_with(one.first); });
    plain += sign == kSigns.end() ? name.front() : sign->second;
    name.remove_prefix(sign == kSigns.end() ? 1 : sign->first.size());
  }
  return plain;
}

using SpeltUnit = std::pair<std::string_view, std::string_view>;

/// "ms" of "Milliseconds", "N.m" of "newton-meters", "m/s2" of "m s-2"; "" of what is no unit that is spelt out.
std::string spelt_out(std::string_view name) {
  constexpr auto kOtherSigns = std::to_array<SpeltUnit>({{"m s-2", "m/s2"},
                                                         {"m s^-2", "m/s2"},
                                                         {"m s**-2", "m/s2"},
                                                         {"m/s**2", "m/s2"},
                                                         {"m/s/s", "m/s2"},
                                                         {"rad s-2", "rad/s2"},
                                                         {"N m", "N.m"},
                                                         {"N-m", "N.m"}});
  constexpr auto kPrefixes =
      std::to_array<SpeltUnit>({{"milli", "m"}, {"micro", "u"}, {"nano", "n"}, {"centi", "c"}, {"kilo", "k"}});
  constexpr auto kWords = std::to_array<SpeltUnit>({{"second", "s"},
                                                    {"sec", "s"},
                                                    {"msec", "ms"},
                                                    {"usec", "us"},
                                                    {"nsec", "ns"},
                                                    {"meter", "m"},
                                                    {"metre", "m"},
                                                    {"inch", "in"},
                                                    {"inche", "in"},
                                                    {"radian", "rad"},
                                                    {"degree", "deg"},
                                                    {"newton", "N"},
                                                    {"newtonmeter", "N.m"},
                                                    {"newtonmetre", "N.m"},
                                                    {"newtonmillimeter", "N.mm"},
                                                    {"volt", "V"}});
  const auto other = std::ranges::find(kOtherSigns, name, &SpeltUnit::first);
  if (other != kOtherSigns.end()) return std::string(other->second);
  std::string letters;
  for (const char c : name) {
    if (c != ' ' && c != '-' && c != '*' && c != '.') letters += static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  }
  std::string_view word = letters;
  const auto prefix =
      std::ranges::find_if(kPrefixes, [&](const SpeltUnit& one) { return word.starts_with(one.first); });
  if (prefix != kPrefixes.end()) word.remove_prefix(prefix->first.size());
  const auto found = std::ranges::find_if(kWords, [&](const SpeltUnit& one) {
    return word.starts_with(one.first) && (word.size() == one.first.size() || word.substr(one.first.size()) == "s");
  });
  if (found == kWords.end()) return "";
  return std::string(prefix != kPrefixes.end() ? prefix->second : "") + std::string(found->second);
}

}  // namespace

const Unit* find_unit(std::string_view name) {
  const auto unit = std::ranges::find(kUnits, name, &Unit::name);
  if (unit != kUnits.end()) return &*unit;
  if (const std::string plain = in_ascii(name); plain != name) return find_unit(plain);
  const std::string symbol = spelt_out(name);
  const auto spelt = std::ranges::find(kUnits, symbol, &Unit::name);
  return spelt == kUnits.end() ? nullptr : &*spelt;
}

std::string_view si_unit(Dimension dimension) {
  return std::ranges::find(kUnits, dimension, &Unit::dimension)->name;
}

std::span<const Unit> units() {
  return kUnits;
}

std::string unit_names(std::span<const Dimension> dimensions) {
  std::string names;
  for (const Unit& unit : kUnits) {
    if (std::ranges::find(dimensions, unit.dimension) == dimensions.end()) continue;
    if (!names.empty()) names += ", ";
    names += unit.name;
  }
  return names;
}

}  // namespace mbk::recording
