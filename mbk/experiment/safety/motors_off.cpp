#include "mbk/experiment/safety/motors_off.h"

#include <fmt/format.h>

namespace mbk::safety {
namespace {

std::string reason(const MotorsOff& motors) {
  using Why = MotorsOff::Why;
  switch (motors.why) {
    case Why::nothing:
      break;
    case Why::no_state:
      return "no state arrived from the robot after the stop";
    case Why::not_answered:
      return "the robot did not acknowledge the stop";
    case Why::flag:
      return "the robot reports that its motors are on";
    case Why::drives:
      return fmt::format("its drives measure a torque of {:.2f} N·m", motors.torque);
    case Why::no_tick:
      return "the robot's driver does not return, so no command reaches the robot";
    case Why::motion:
      return motors.torque > 0.0 ? fmt::format("the motion shows a motor torque of {:.2f} N·m", motors.torque)
                                 : "too few states arrived to see whether the motors still drive it";
  }
  return "";
}

}  // namespace

std::string sentence(const MotorsOff& motors) {
  switch (motors.state) {
    case MotorsOff::State::not_asked:
      return "commanded on";
    case MotorsOff::State::waiting:
      return "commanded off, not confirmed yet";
    case MotorsOff::State::confirmed:
      return fmt::format("confirmed off by the robot {:.3f} s after the stop; {}", motors.after,
                         motors.by_motion ? fmt::format("its motion shows no torque above {:g} N·m", motors.limit)
                                          : std::string("its motion was not checked"));
    case MotorsOff::State::missing:
      return fmt::format("NOT CONFIRMED OFF {:.1f} s after the stop: {}; cut their power with the hardware stop button",
                         motors.after, reason(motors));
    case MotorsOff::State::cannot_say:
      return "commanded off; this robot's driver does not report whether they are off";
  }
  return "";
}

}  // namespace mbk::safety
