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
      return "no state of the robot came after the stop";
    case Why::not_answered:
      return "the robot did not acknowledge the stop";
    case Why::flag:
      return "the robot says that its motors are on";
    case Why::drives:
      return fmt::format("its drives measure a torque of {:.2f} N·m", motors.torque);
    case Why::no_tick:
      return "the robot's driver does not return, so that no command reaches it";
    case Why::motion:
      return motors.torque > 0.0 ? fmt::format("the motion shows a torque of the motors of {:.2f} N·m", motors.torque)
                                 : "its states were too few to see whether it is still driven";
  }
  return "";
}

}  // namespace

std::string sentence(const MotorsOff& motors) {
  switch (motors.state) {
    case MotorsOff::State::not_asked:
      return "commanded on";
    case MotorsOff::State::waiting:
      return "off was commanded, not confirmed yet";
    case MotorsOff::State::confirmed:
      return fmt::format("confirmed off by the robot {:.3f} s after the stop; {}", motors.after,
                         motors.by_motion ? fmt::format("its motion shows no torque above {:g} N·m", motors.limit)
                                          : std::string("its motion was not checked"));
    case MotorsOff::State::missing:
      return fmt::format("NOT CONFIRMED OFF {:.1f} s after the stop: {}; cut their power with the hardware stop button",
                         motors.after, reason(motors));
    case MotorsOff::State::cannot_say:
      return "off was commanded; this robot's driver does not report whether they are";
  }
  return "";
}

}  // namespace mbk::safety
