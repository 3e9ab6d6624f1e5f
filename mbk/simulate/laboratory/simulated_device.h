#pragma once

#include <memory>

#include "mbk/base/core/result.h"
#include "mbk/experiment/device/device.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {

/// The planar robot of a scenario with its load, as a device without hardware. It advances by one tick with each
/// command and waits for it, independent of the clock. Because sensors between two torques read both, force and
/// acceleration of a tick come with the next state (Facts::force_latency = 1); then the same torques give exactly the
/// recording of `simulate`.
class SimulatedDevice : public device::Device {
 public:
  /// At rest at the scenario's home.
  /// @fails  usage: the scenario is not planar; as ClosedLoop, SensorSuite and the loads.
  [[nodiscard]] static Result<std::unique_ptr<SimulatedDevice>> create(const Scenario& scenario);

  [[nodiscard]] const device::Facts& facts() const override { return facts_; }
  [[nodiscard]] Result<void> start() override { return {}; }
  bool read(device::State& state) noexcept override;
  bool write(const device::Command& command) noexcept override;
  void stop() noexcept override {}

  /// True motor positions, independent of the encoders [rad].
  [[nodiscard]] Vector2d motor_angle() const { return loop_.motor_angle(); }

  /// True state at the beginning of the last tick.
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
