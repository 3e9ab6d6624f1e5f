#pragma once

#include <cstdint>
#include <string>

#include "mbk/base/core/words.h"

namespace mbk::safety {

/// Whether the robot has confirmed that its motors are off.
struct MotorsOff {
  enum class State : std::uint8_t {
    not_asked,   ///< the motors are driven
    waiting,     ///< off was commanded; the robot has not confirmed it yet
    confirmed,   ///< as reported by the robot
    missing,     ///< no confirmation within Limits::motors_off
    cannot_say,  ///< the robot does not report its motors' state
  };
  /// The first condition that is missing for a confirmation.
  enum class Why : std::uint8_t { nothing, no_state, not_answered, flag, drives, motion, no_tick };

  State state = State::not_asked;
  double after = 0.0;      ///< from the first command with motors off to the confirmation, or to giving up [s]
  bool by_motion = false;  ///< confirmed by the motion too: encoders and force sensor show no torque of the motors
  Why why = Why::nothing;
  double torque = 0.0;  ///< shown by drives or motion [N·m]
  double limit = 0.0;   ///< maximum that the motion may show if the motors are off [N·m]
};

/// For files and machines.
[[nodiscard]] constexpr auto word_table(MotorsOff::State) {
  using enum MotorsOff::State;
  return std::to_array<Word<MotorsOff::State>>({{not_asked, "driven"},
                                                {waiting, "waiting"},
                                                {confirmed, "confirmed"},
                                                {missing, "not confirmed"},
                                                {cannot_say, "not reported"}});
}

/// "confirmed off by the robot 0.045 s after the stop", "NOT CONFIRMED OFF: …": for people.
[[nodiscard]] std::string sentence(const MotorsOff& motors);

}  // namespace mbk::safety
