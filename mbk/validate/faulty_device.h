#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "mbk/experiment/device/device.h"
#include "mbk/simulate/laboratory/simulated_device.h"

namespace mbk::validation {

using Eigen::Vector2d;

/// What goes wrong at a robot from one tick on. `k` counts the ticks since; each part may be empty.
struct DeviceFault {
  std::function<bool(device::State& state, int k)> reading;      ///< spoils what is read; false: the link is broken
  std::function<bool(device::Command& command, int k)> driving;  ///< spoils what the motors do; false: as above
  std::function<Vector2d(int k)> push;  ///< a further force of the hand on the robot, base frame [N]
};

/// The simulated robot with a fault that begins at a tick, and a protocol of every command that reached it. A push is
/// exact: with a force F at the handle the motion is that of the torque τ + JᵀF, and the sensor reads F besides.
class FaultyDevice : public device::Device {
 public:
  /// @param onset  tick from 0 at which the fault begins
  /// @param ticks  as many commands are remembered without allocation
  FaultyDevice(laboratory::SimulatedDevice& robot, const robot::Geometry& geometry, DeviceFault fault,
               std::int64_t onset, bool keeps_time, std::size_t ticks);

  [[nodiscard]] const device::Facts& facts() const override { return facts_; }
  [[nodiscard]] Result<void> start() override { return robot_->start(); }
  bool read(device::State& state) noexcept override;
  bool write(const device::Command& command) noexcept override;
  void stop() noexcept override;

  /// From any thread: the tick that the robot is at, and whether it was stopped.
  [[nodiscard]] std::int64_t tick() const { return tick_.load(); }
  [[nodiscard]] bool stopped() const { return stopped_.load(); }

  /// Of the hand since the onset, by the true angles, over 10 ms [m/s].
  [[nodiscard]] double largest_speed() const { return largest_speed_; }

  /// One command as it came, and the force that it stands for at the handle with the joints where they truly are.
  struct Received {
    device::Command command;
    double handle_force;  ///< |J⁻ᵀτ| [N]
  };
  [[nodiscard]] const std::vector<Received>& received() const { return received_; }

 private:
  laboratory::SimulatedDevice* robot_;
  robot::Geometry geometry_;
  DeviceFault fault_;
  device::Facts facts_;
  std::int64_t onset_;
  std::atomic<std::int64_t> tick_{0};
  std::atomic<bool> stopped_{false};
  Vector2d pushed_ = {0.0, 0.0};  // at the tick before: what the sensor reads now
  std::vector<Received> received_;
  static constexpr std::size_t kSpeedTicks = 10;
  std::array<Vector2d, kSpeedTicks> hands_{};  // ring
  double largest_speed_ = 0.0;
};

}  // namespace mbk::validation
