#include "mbk/experiment/device/wiring.h"

namespace mbk::device {

State Wiring::state(const RawState& raw) const noexcept {
  State state;
  state.sequence = raw.sequence;
  state.time = raw.time;
  state.stop = raw.stop;
  state.joint = radians_per_count.cwiseProduct(raw.encoder - count_offset);
  const Eigen::Matrix2d axes = robot::link_axes(state.joint[1]);
  const auto turned = [&](const Vector2d& reading, Frame frame) {
    return frame == Frame::base ? reading : Vector2d(axes * reading);
  };
  state.force = turned(force_gain * (raw.force - force_offset), force_frame);
  state.acceleration = turned(acceleration_gain * (raw.acceleration - acceleration_offset), acceleration_frame);
  return state;
}

Vector2d Wiring::command(const Vector2d& torque) const noexcept {
  return torque.cwiseQuotient(torque_per_command);
}

}  // namespace mbk::device
