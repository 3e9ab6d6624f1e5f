#include "mbk/simulate/laboratory/simulated_device.h"

#include "mbk/simulate/laboratory/make_load.h"

namespace mbk::laboratory {

SimulatedDevice::SimulatedDevice(const Scenario& scenario, std::unique_ptr<participant::Load<2>> load,
                                 ClosedLoop<2> loop, SensorSuite<2> sensors)
    : load_(std::move(load)), loop_(std::move(loop)), sensors_(std::move(sensors)) {
  facts_.name = "simulated robot, " + (scenario.condition.empty() ? scenario.protocol : scenario.condition);
  facts_.keeps_time = false;
  facts_.acknowledges = true;
  facts_.force_latency = 1;
}

Result<std::unique_ptr<SimulatedDevice>> SimulatedDevice::create(const Scenario& scenario) {
  const auto* trial = std::get_if<PlanarTrial>(&scenario.trial);
  if (trial == nullptr) {
    return bad_usage("a one-axis machine cannot run as an experiment yet",
                     "use a planar robot, or record a one-axis machine with 'mbk simulate'");
  }
  auto load = MBK_TRY(make_load(scenario, *trial));
  const double sample_time = 1.0 / scenario.rate.value;
  auto loop = MBK_TRY(ClosedLoop<2>::create(trial->robot, trial->home, *load, sample_time));
  auto sensors =
      MBK_TRY(SensorSuite<2>::create(trial->sensors, trial->robot.robot.geometry, sample_time, scenario.seed));
  return std::unique_ptr<SimulatedDevice>(
      new SimulatedDevice(scenario, std::move(load), std::move(loop), std::move(sensors)));
}

bool SimulatedDevice::read(device::State& state) noexcept {
  state.sequence = sequence_ + 1;
  state.time = loop_.time();
  state.joint = sensors_.encoders(loop_.motor_angle());
  state.force = reading_.force;
  state.acceleration = reading_.acceleration;
  state.stop = false;
  state.answered = sequence_;
  state.motors = enabled_ ? device::Motors::on : device::Motors::off;
  return true;
}

bool SimulatedDevice::write(const device::Command& command) noexcept {
  const Vector2d torque = command.enabled ? command.torque : Vector2d::Zero();
  enabled_ = command.enabled;
  truth_ = loop_.hold(torque, sensors_.next_interval());
  reading_ = sensors_.read(truth_);
  loop_.advance();
  ++sequence_;
  return true;
}

}  // namespace mbk::laboratory
