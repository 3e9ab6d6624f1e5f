#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "mbk/base/core/words.h"

namespace mbk::safety {

/// Why the gate switched the motors off. Journals store the numbers: append new ones.
enum class Reason : std::uint8_t {
  none,
  stop_button,    ///< of the robot
  operator_stop,  ///< key, console, or a signal (Trip::value is its number)
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
  robot_fault,       ///< its own fault code
  robot_watchdog,    ///< the robot reports that no command arrived in time
  robot_clock,       ///< stopped, backwards, too fast, or not finite
  state_old,         ///< states are too old
  answer_late,       ///< the robot obeys old commands
  answer_wrong,      ///< it acknowledges a command never sent, or takes an acknowledgement back
  motors_off,        ///< it reports "motors off" while driven
  motors_on,         ///< its motors were not confirmed off after the trial
  sensor_missing,    ///< a sensor present at the start is missing
  torque_disagrees,  ///< drives or motion show a torque other than the commanded one
  loop_stalled,      ///< the robot's driver did not return
};

inline constexpr int kReasons = static_cast<int>(Reason::loop_stalled) + 1;

/// For files and machines.
[[nodiscard]] constexpr auto word_table(Reason) {
  using enum Reason;
  return std::to_array<Word<Reason>>({
      {none, "none"},
      {stop_button, "stop-button"},
      {operator_stop, "operator-stop"},
      {link_lost, "link-lost"},
      {late, "late"},
      {recording_failed, "recording-failed"},
      {controller_not_finite, "controller-not-finite"},
      {encoder_not_finite, "encoder-not-finite"},
      {force_not_finite, "force-not-finite"},
      {accelerometer_not_finite, "accelerometer-not-finite"},
      {encoder_jump, "encoder-jump"},
      {force_jump, "force-jump"},
      {encoder_frozen, "encoder-frozen"},
      {force_frozen, "force-frozen"},
      {accelerometer_frozen, "accelerometer-frozen"},
      {accelerometer_disagrees, "accelerometer-disagrees"},
      {measured_force, "measured-force"},
      {speed, "speed"},
      {acceleration, "acceleration"},
      {workspace, "workspace"},
      {joint_margin, "joint-margin"},
      {excursion, "excursion"},
      {tracking, "tracking"},
      {limited_too_long, "limited-too-long"},
      {robot_fault, "robot-fault"},
      {robot_watchdog, "robot-watchdog"},
      {robot_clock, "robot-clock"},
      {state_old, "state-old"},
      {answer_late, "answer-late"},
      {answer_wrong, "answer-wrong"},
      {motors_off, "motors-off"},
      {motors_on, "motors-on"},
      {sensor_missing, "sensor-missing"},
      {torque_disagrees, "torque-disagrees"},
      {loop_stalled, "loop-stalled"},
  });
}

/// A trip, with the measured value and its limit.
struct Trip {
  Reason reason = Reason::none;
  double time = 0.0;       ///< on the loop's clock [s]
  std::uint64_t tick = 0;  ///< since the gate was made
  double value = 0.0;      ///< in `unit(reason)`; 0 where it has none
  double limit = 0.0;
};

/// Unit of value and limit; "" where there are none.
[[nodiscard]] std::string_view unit(Reason reason);

/// For people: "the measured force was 41.2 N (limit 40 N), at 12.345 s; somebody or something pushes the handle".
[[nodiscard]] std::string sentence(const Trip& trip);

}  // namespace mbk::safety
