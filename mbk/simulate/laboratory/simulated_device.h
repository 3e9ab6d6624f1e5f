#pragma once

#include <memory>

#include "mbk/base/core/result.h"
#include "mbk/experiment/device/device.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {

/// The planar robot of a scenario, with whoever holds its handle, as a device: it needs nothing. It moves on by one
/// tick with each command and waits for it, whatever the clock says. As sensors between two torques read both, force
/// and acceleration of a tick are there with the next state (Facts::force_latency = 1); with that, the same torques
/// give the same recording as `simulate`, to the bit.
class SimulatedDevice : public device::Device {
 public:
  /// At rest at the scenario's home.
  /// @fails  usage: the scenario is no planar one; as ClosedLoop, SensorSuite and the loads.
  [[nodiscard]] static Result<std::unique_ptr<SimulatedDevice>> create(const Scenario& scenario);

  [[nodiscard]] const device::Facts& facts() const override { return facts_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  bool read(device::State& state) noexcept override;
  bool write(const device::Command& command) noexcept override;
  void stop() noexcept override {}

  /// Where the joints' motors are in truth, whatever the encoders say [rad].
  [[nodiscard]] Vector2d motor_angle() const { return loop_.motor_angle(); }

  /// Everything in truth at the beginning of the last tick.
  [[nodiscard]] const TrueState<2>& truth() const { return truth_; }

 private:
  SimulatedDevice(const Scenario& scenario, std::unique_ptr<participant::Load<2>> load, ClosedLoop<2> loop,
                  SensorSuite<2> sensors);

  device::Facts facts_;
  std::unique_ptr<participant::Load<2>> load_;
  ClosedLoop<2> loop_;
  SensorSuite<2> sensors_;
  SensorSuite<2>::Reading reading_{};
  TrueState<2> truth_;
  std::uint64_t sequence_ = 0;
  bool enabled_ = false;
};

}  // namespace mbk::laboratory
