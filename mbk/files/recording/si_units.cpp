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
    // rare ones
    {"ft", length, 0.3048, 1},
    {"mil", length, 0.0254, 1e3},
    {"gf", force, 9.80665, 1e3},
    {"ozf", force, 0.27801385095378125, 1},
    {"N.cm", torque, 1, 1e2},
    {"lbf.in", torque, 0.1129848290276167, 1},
    {"lbf.ft", torque, 1.3558179483314004, 1},
});

/// Names that are spelled out, for which case does not count, and other spellings; in small letters. Units of mass
/// stand for the weight: no channel is a mass.
constexpr auto kSpellings = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"sec", "s"},
    {"second", "s"},
    {"msec", "ms"},
    {"millisec", "ms"},
    {"millisecond", "ms"},
    {"usec", "us"},
    {"microsec", "us"},
    {"microsecond", "us"},
    {"nsec", "ns"},
    {"nanosecond", "ns"},
    {"minute", "min"},
    {"hour", "h"},
    {"meter", "m"},
    {"metre", "m"},
    {"centimeter", "cm"},
    {"centimetre", "cm"},
    {"millimeter", "mm"},
    {"millimetre", "mm"},
    {"micrometer", "um"},
    {"micrometre", "um"},
    {"micron", "um"},
    {"inch", "in"},
    {"inches", "in"},
    {"foot", "ft"},
    {"feet", "ft"},
    {"ft", "ft"},
    {"mil", "mil"},
    {"thou", "mil"},
    {"rad", "rad"},
    {"radian", "rad"},
    {"milliradian", "mrad"},
    {"deg", "deg"},
    {"degree", "deg"},
    {"newton", "N"},
    {"kilonewton", "kN"},
    {"millinewton", "mN"},
    {"lb", "lbf"},
    {"lbf", "lbf"},
    {"pound", "lbf"},
    {"pound-force", "lbf"},
    {"kg", "kgf"},
    {"kgf", "kgf"},
    {"kp", "kgf"},
    {"kilogram", "kgf"},
    {"kilogram-force", "kgf"},
    {"gf", "gf"},
    {"gram", "gf"},
    {"gram-force", "gf"},
    {"oz", "ozf"},
    {"ozf", "ozf"},
    {"ounce", "ozf"},
    {"ncm", "N.cm"},
    {"n-cm", "N.cm"},
    {"lb-in", "lbf.in"},
    {"lb.in", "lbf.in"},
    {"lbf-in", "lbf.in"},
    {"in-lb", "lbf.in"},
    {"in-lbf", "lbf.in"},
    {"lb-ft", "lbf.ft"},
    {"lb.ft", "lbf.ft"},
    {"lbf-ft", "lbf.ft"},
    {"ft-lb", "lbf.ft"},
    {"ft-lbf", "lbf.ft"},
    {"n-m", "N.m"},
    {"newton meter", "N.m"},
    {"newton-meter", "N.m"},
    {"newtonmeter", "N.m"},
    {"newton metre", "N.m"},
    {"newton-metre", "N.m"},
    {"n-mm", "N.mm"},
    {"newton millimeter", "N.mm"},
    {"newton-millimeter", "N.mm"},
    {"newton millimetre", "N.mm"},
    {"m/s^2^", "m/s2"},
    {"m/s/s", "m/s2"},
    {"m/s**2", "m/s2"},
    {"m s-2", "m/s2"},
    {"m s^-2", "m/s2"},
    {"m s**-2", "m/s2"},
    {"rad s-2", "rad/s2"},
    {"n m", "N.m"},
    {"volt", "V"},
    {"millivolt", "mV"},
    {"microvolt", "uV"},
});

/// The unit of a spelling; one that ends in s may be more than one of it.
const Unit* spelled_out(std::string_view name) {
  constexpr std::size_t kShortest = 2, kLongest = 24;
  if (name.size() < kShortest || name.size() > kLongest) return nullptr;
  std::string small(name);
  std::ranges::transform(small, small.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  auto found = std::ranges::find(kSpellings, small, &std::pair<std::string_view, std::string_view>::first);
  if (found == kSpellings.end() && small.back() == 's') {
    small.pop_back();
    found = std::ranges::find(kSpellings, small, &std::pair<std::string_view, std::string_view>::first);
  }
  return found == kSpellings.end() ? nullptr : &*std::ranges::find(kUnits, found->second, &Unit::name);
}

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

}  // namespace

const Unit* find_unit(std::string_view name) {
  const auto unit = std::ranges::find(kUnits, name, &Unit::name);
  if (unit != kUnits.end()) return &*unit;
  if (const Unit* const spelled = spelled_out(name)) return spelled;
  const std::string plain = in_ascii(name);
  return plain == name ? nullptr : find_unit(plain);
}

std::string_view dimension_name(Dimension dimension) {
  switch (dimension) {
    case time:
      return "times";
    case length:
      return "lengths";
    case angle:
      return "angles";
    case force:
      return "forces";
    case torque:
      return "torques";
    case acceleration:
      return "accelerations";
    case angular_acceleration:
      return "angular accelerations";
    case voltage:
      return "voltages";
  }
  return "";
}

std::string_view si_unit(Dimension dimension) {
  return std::ranges::find(kUnits, dimension, &Unit::dimension)->name;
}

std::span<const Unit> units() {
  constexpr std::size_t kRare = 7;
  return std::span(kUnits).first(kUnits.size() - kRare);
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
