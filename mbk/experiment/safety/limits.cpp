#include "mbk/experiment/safety/limits.h"

#include "mbk/base/core/option_limits.h"

namespace mbk::safety {

Result<void> check(const Limits& limits) {
  if (auto ok = above_zero({{"safety: handle force", limits.handle_force, "N"},
                            {"safety: torque of joint 1", limits.joint_torque[0], "N·m"},
                            {"safety: torque of joint 2", limits.joint_torque[1], "N·m"},
                            {"safety: torque rate", limits.torque_rate, "N·m/s"},
                            {"safety: longest time of cutting", limits.max_saturation_time, "s"},
                            {"safety: measured force", limits.measured_force, "N"},
                            {"safety: jump of the force", limits.force_jump, "N"},
                            {"safety: speed", limits.speed, "m/s"},
                            {"safety: acceleration", limits.acceleration, "m/s²"},
                            {"safety: tracking error", limits.tracking, "rad"},
                            {"safety: jump of an encoder", limits.encoder_jump, "rad"},
                            {"safety: torque at a resting encoder", limits.frozen_sensor_torque, "N·m"},
                            {"safety: silence of the link", limits.link_silence, "s"},
                            {"safety: reply of the motors", limits.motors_reply, "s"},
                            {"safety: time for the motors to go off", limits.motors_off, "s"},
                            {"safety: torque of motors that are off", limits.off_torque, "N·m"}});
      !ok) {
    return ok;
  }
  if (auto ok = not_negative({{"safety: joint margin", limits.joint_margin, "rad"},
                              {"safety: excursion", limits.excursion, "m"},
                              {"safety: time of a frozen reading", limits.frozen_sensor, "s"},
                              {"safety: accelerometer against encoders", limits.accelerometer, "m/s²"},
                              {"safety: lateness", limits.lateness, "s"},
                              {"safety: lag of the answer", limits.answer_lag, "s"},
                              {"safety: age of a state", limits.state_age, "s"},
                              {"safety: torque of the motors against the command", limits.torque_error, "N·m"}});
      !ok) {
    return ok;
  }
  if (!(limits.workspace_low.array() < limits.workspace_high.array()).all()) {
    return bad_usage("safety: the workspace's low corner is not below its high corner");
  }
  return {};
}

}  // namespace mbk::safety
