#include "mbk/simulate/laboratory/simulated_device.h"

#include <gtest/gtest.h>

#include "tests/support/allocations.h"

namespace mbk::laboratory {
namespace simulated_device_test {

Scenario ready(const char* name, double seconds) {
  Scenario scenario = read_scenarios(find_ready_scenario(name)->text, name)->front();
  if (auto* sines = std::get_if<perturbation::MultisinePlan>(&scenario.perturbation.kind)) sines->duration = seconds;
  return scenario;
}

TEST(SimulatedDevice, GivesTheRecordingOfSimulateToTheBit) {
  const Scenario scenario = ready("rigid_sinusoidal_6N", 8.0);
  const Recording recording = simulate(scenario)->recording;
  auto device = SimulatedDevice::create(scenario);
  ASSERT_TRUE(device) << device.error().line();
  EXPECT_EQ((*device)->facts().force_latency, 1);
  const auto value = [&](const char* channel, Index i) { return recording.find(channel)->values[i]; };
  device::State state;
  for (Index i = 0; i < recording.samples(); ++i) {
    ASSERT_TRUE((*device)->read(state));
    ASSERT_EQ(state.sequence, static_cast<std::uint64_t>(i) + 1);
    ASSERT_EQ(state.joint[0], value("joint_1", i)) << i;
    ASSERT_EQ(state.joint[1], value("joint_2", i)) << i;
    if (i > 0) {
      ASSERT_EQ(state.force[0], value("force_x", i - 1)) << i;
      ASSERT_EQ(state.acceleration[1], value("acceleration_y", i - 1)) << i;
    }
    const device::Command command{static_cast<std::uint64_t>(i), {value("torque_1", i), value("torque_2", i)}, true};
    ASSERT_TRUE((*device)->write(command));
  }
}

TEST(SimulatedDevice, StandsStillUntilACommandComes) {
  auto device = SimulatedDevice::create(ready("relaxed_sinusoidal", 8.0)).value();
  device::State first, second;
  device->read(first);
  device->read(second);
  EXPECT_EQ(first.sequence, second.sequence);
  EXPECT_EQ(first.joint, second.joint);
}

TEST(SimulatedDevice, PutsNoTorqueOnADisabledDrive) {
  const Scenario scenario = ready("free_motion", 8.0);
  auto off = SimulatedDevice::create(scenario).value(), zero = SimulatedDevice::create(scenario).value();
  device::State a, b;
  for (std::uint64_t i = 0; i < 500; ++i) {
    off->read(a);
    zero->read(b);
    ASSERT_EQ(a.joint, b.joint);
    off->write({i, {2.0, -2.0}, false});
    zero->write({i, {0.0, 0.0}, true});
  }
}

TEST(SimulatedDevice, DoesNotAllocate) {
  auto device = SimulatedDevice::create(ready("rigid_sinusoidal_6N", 8.0)).value();
  device::State state;
  const long before = testing_support::allocations();
  for (std::uint64_t i = 0; i < 2000; ++i) {
    device->read(state);
    device->write({i, {0.1, 0.1}, true});
  }
  EXPECT_EQ(testing_support::allocations(), before);
}

TEST(SimulatedDevice, RefusesAOneAxisMachine) {
  EXPECT_FALSE(SimulatedDevice::create(ready("ankle_reflex", 8.0)));
}

}  // namespace simulated_device_test
}  // namespace mbk::laboratory
