#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace mbk::safety {

/// Why the gate switched the motors off.
enum class Reason : std::uint8_t {
  none,
  stop_button,    ///< of the robot
  operator_stop,  ///< key or console
  link_lost,
  late,
  recording_failed,
  controller_not_finite,
  encoder_not_finite,
  force_not_finite,
  accelerometer_not_finite,
  encoder_jump,
  force_jump,
  encoder_frozen,
  force_frozen,
  accelerometer_frozen,
  accelerometer_disagrees,
  measured_force,
  speed,
  acceleration,
  workspace,
  joint_margin,
  excursion,
  tracking,
  limited_too_long,
};

inline constexpr int kReasons = static_cast<int>(Reason::limited_too_long) + 1;

/// "force-jump": for files and machines.
[[nodiscard]] std::string_view code(Reason reason);

/// A trip with what was measured against what limit.
struct Trip {
  Reason reason = Reason::none;
  double time = 0.0;       ///< on the loop's clock [s]
  std::uint64_t tick = 0;  ///< since the gate was made
  double value = 0.0;      ///< in `unit(reason)`; 0 where it has none
  double limit = 0.0;
};

/// Unit of value and limit; "" where there are none.
[[nodiscard]] std::string_view unit(Reason reason);

/// "the measured force was 41.2 N, beyond 40 N, at 12.345 s: somebody or something pushes the handle": for people.
[[nodiscard]] std::string sentence(const Trip& trip);

}  // namespace mbk::safety
