#pragma once

#include <array>
#include <cstddef>

#include "mbk/model/robot/kinematics.h"

namespace mbk::safety {

using Eigen::Vector2d;

/// One new state of the robot, as far as motion is concerned.
struct MotionSample {
  double time = 0.0;                   ///< on the robot's clock [s]
  Vector2d joint = {0.0, 0.0};         ///< [rad]
  Vector2d hand = {0.0, 0.0};          ///< hand position, base frame [m]
  Vector2d acceleration = {0.0, 0.0};  ///< by the accelerometer, base frame [m/s²]
  Vector2d force = {0.0, 0.0};         ///< of the hand on the robot, base frame [N]
  Vector2d torque = {0.0, 0.0};        ///< that the robot was told to exert [N·m]
};

/// The last 2·kHalf + 1 states with the robot's own time stamps, so that a state that is lost or comes late is no
/// motion. The mean of an acceleration under the triangle that has its tip at the middle sample t₁ and ends at the
/// oldest t₀ and the newest t₂ is exactly
///   ⟨ẍ⟩ = 2 [(x₂ − x₁)/(t₂ − t₁) − (x₁ − x₀)/(t₁ − t₀)] / (t₂ − t₀)
/// and what is measured besides is averaged under the same triangle, so that both can be compared. Nothing allocates.
class MotionWindow {
 public:
  static constexpr int kHalf = 20;  ///< samples
  static constexpr int kSize = 2 * kHalf + 1;

  void forget() noexcept { filled_ = 0; }
  void add(const MotionSample& sample) noexcept;

  [[nodiscard]] bool half() const noexcept { return filled_ > kHalf; }
  [[nodiscard]] bool full() const noexcept { return filled_ == kSize; }

  /// The newest state, and one so many states before it. Meant where so many are there.
  [[nodiscard]] const MotionSample& before(int states) const noexcept;

  /// Of the hand from kHalf states before to the newest [m/s]. Meant where `half`.
  [[nodiscard]] double speed() const noexcept;

  /// Means under the triangle. Meant where `full`.
  struct Means {
    Vector2d hand_acceleration, joint_acceleration, joint_rate;  ///< by the encoders
    Vector2d acceleration, force, torque;
  };
  [[nodiscard]] Means means() const noexcept;

 private:
  std::array<MotionSample, kSize> samples_{};  // ring, newest at `at_`
  int at_ = 0, filled_ = 0;
};

}  // namespace mbk::safety
