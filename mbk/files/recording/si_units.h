#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace mbk::recording {

/// What a number measures. Units are handled only here; all other code uses SI units and radians.
enum class Dimension { time, length, angle, force, torque, acceleration, angular_acceleration, voltage };

/// A unit of a file: value in SI = value · multiply / divide. Two factors, so that 153 mm is exactly 0.153 m.
struct Unit {
  std::string_view name;
  Dimension dimension;
  double multiply;
  double divide;

  [[nodiscard]] double to_si(double value) const { return value * multiply / divide; }
};

/// The unit of that name ("mm", "µs", "N.m", "N·m", "Nm", "m/s2", "m/s²", "m/s^2"), or nullptr. Case matters: mN is not
/// MN. It is ignored in names that are spelled out ("Millimeters", "sec", "degrees", "newtons").
[[nodiscard]] const Unit* find_unit(std::string_view name);

/// "lengths", "angles": the quantity of a dimension, for messages.
[[nodiscard]] std::string_view dimension_name(Dimension dimension);

/// The SI unit of a dimension, as Channel::unit writes it.
[[nodiscard]] std::string_view si_unit(Dimension dimension);

/// Units that numbers without a stated unit may have: all except the rare ones at the end of the table.
[[nodiscard]] std::span<const Unit> units();

/// "m, cm, mm, um, in": every unit that measures one of the dimensions, for messages.
[[nodiscard]] std::string unit_names(std::span<const Dimension> dimensions);

}  // namespace mbk::recording
