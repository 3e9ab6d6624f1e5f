#pragma once

#include <compare>
#include <limits>
#include <numbers>

namespace mbk {

struct RadPerSec;

/// Frequency in cycles per second. A different type from RadPerSec, so that a factor 2π cannot get lost.
struct Hertz {
  double value = 0.0;
  constexpr Hertz() = default;
  constexpr explicit Hertz(double hz) : value(hz) {}
  constexpr explicit Hertz(RadPerSec omega);
  auto operator<=>(const Hertz&) const = default;
};

/// Angular frequency in radians per second.
struct RadPerSec {
  double value = 0.0;
  constexpr RadPerSec() = default;
  constexpr explicit RadPerSec(double omega) : value(omega) {}
  constexpr explicit RadPerSec(Hertz frequency) : value(2.0 * std::numbers::pi * frequency.value) {}
  auto operator<=>(const RadPerSec&) const = default;
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kDegree = std::numbers::pi / 180.0;   ///< [rad]
inline constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< in a radian
inline constexpr double kMillimetres = 1000.0;                ///< in a metre
inline constexpr double kMilliseconds = 1000.0;               ///< in a second

constexpr Hertz::Hertz(RadPerSec omega) : value(omega.value / (2.0 * std::numbers::pi)) {}

}  // namespace mbk
