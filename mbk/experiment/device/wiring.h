#pragma once

#include "mbk/base/core/words.h"
#include "mbk/experiment/device/device.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::device {

/// What a robot's electronics give and take, in their own units.
struct RawState {
  std::uint64_t sequence = 0;
  double time = 0.0;                   ///< [s]
  Vector2d encoder = {0.0, 0.0};       ///< counts, or angles where a count is one radian
  Vector2d force = {0.0, 0.0};         ///< [V], or [N]
  Vector2d acceleration = {0.0, 0.0};  ///< [V], or [m/s²]
  bool stop = false;
};

/// From a robot's own units to SI units in the base frame and back. By default nothing is changed.
struct Wiring {
  enum class Frame { base, last_link };  ///< of what sensors read; last_link: x along it, away from the elbow

  Vector2d radians_per_count = {1.0, 1.0};                   ///< a minus turns the sense [rad] ≠ 0
  Vector2d count_offset = {0.0, 0.0};                        ///< count at θ = 0
  Eigen::Matrix2d force_gain = Eigen::Matrix2d::Identity();  ///< [N per unit]
  Vector2d force_offset = {0.0, 0.0};                        ///< reading without a force [unit]
  Frame force_frame = Frame::base;
  Eigen::Matrix2d acceleration_gain = Eigen::Matrix2d::Identity();  ///< [m/s² per unit]
  Vector2d acceleration_offset = {0.0, 0.0};                        ///< reading at rest [unit]
  Frame acceleration_frame = Frame::base;
  Vector2d torque_per_command = {1.0, 1.0};  ///< joint torque of one unit of command, [N·m/A] × gear ≠ 0

  /// θ = radians_per_count (counts − count_offset), F = R G (reading − offset) with R of θ₂.
  [[nodiscard]] State state(const RawState& raw) const noexcept;

  /// τ of a command, or of a torque that the drives measure in its unit [N·m].
  [[nodiscard]] Vector2d torque(const Vector2d& command) const noexcept {
    return torque_per_command.cwiseProduct(command);
  }

  /// The command in the robot's unit: τ / torque_per_command.
  [[nodiscard]] Vector2d command(const Vector2d& torque) const noexcept;
};

[[nodiscard]] constexpr auto word_table(Wiring::Frame) {
  using enum Wiring::Frame;
  return std::to_array<Word<Wiring::Frame>>({{base, "base"}, {last_link, "last_link"}});
}

}  // namespace mbk::device
