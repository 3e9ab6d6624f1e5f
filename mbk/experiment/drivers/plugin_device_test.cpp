#include "mbk/experiment/drivers/plugin_device.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/allocations.h"

namespace mbk::drivers {
namespace {

Fittings without_sensors() {
  Fittings fittings;
  fittings.has_force = fittings.has_acceleration = false;
  return fittings;
}

std::unique_ptr<PluginDevice> my_robot(const std::string& settings = "", const Fittings& fittings = without_sensors()) {
  auto made = PluginDevice::create({MBK_MY_ROBOT, settings}, fittings);
  EXPECT_TRUE(made) << made.error().line();
  return std::move(*made);
}

std::string refusal(const char* library, const Fittings& fittings = {}) {
  const auto made = PluginDevice::create({library, ""}, fittings);
  EXPECT_FALSE(made);
  return made ? "" : made.error().line();
}

TEST(PluginDevice, TheExampleTurnsAsItsInertiaSays) {
  auto device = my_robot("0.5 1.25");
  EXPECT_EQ(device->facts().name, "two wheels");
  EXPECT_FALSE(device->facts().keeps_time);
  ASSERT_TRUE(device->start());
  device::State state;
  ASSERT_TRUE(device->read(state));
  EXPECT_EQ(state.joint, Eigen::Vector2d(0.5, 1.25));
  // Each tick ω ← ω + T (τ − b ω)/I and θ ← θ + T ω: ω[k] = (τ/b)(1 − (1 − T b/I)ᵏ).
  double angle = 0.5, speed = 0.0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(device->write({i, {0.3, 0.0}, true}));
    ASSERT_TRUE(device->read(state));
    ASSERT_EQ(state.sequence, i + 2);
    speed = 3.0 * (1.0 - std::pow(1.0 - 1e-4 / 0.07, static_cast<double>(i + 1)));
    angle += 1e-3 * speed;
  }
  EXPECT_NEAR(state.joint[0], angle, 1e-12);  // rounding of 1000 sums
  EXPECT_EQ(state.joint[1], 1.25);
}

TEST(PluginDevice, StopTakesTheTorqueAway) {
  auto device = my_robot();
  ASSERT_TRUE(device->start());
  device->stop();
  device::State state;
  device->read(state);
  EXPECT_EQ(state.joint, Eigen::Vector2d(0.0, 0.0));
}

TEST(PluginDevice, ReadsAndCommandsThroughTheWiring) {
  Fittings fittings = without_sensors();
  fittings.wiring.radians_per_count = {-1.0, 1.0};
  fittings.wiring.torque_per_command = {2.0, 1.0};
  auto turned = my_robot("", fittings), plain = my_robot();
  ASSERT_TRUE(turned->start() && plain->start());
  turned->write({0, {1.0, 0.0}, true});
  plain->write({0, {0.5, 0.0}, true});
  device::State a, b;
  turned->read(a);
  plain->read(b);
  EXPECT_GT(b.joint[0], 0.0);
  EXPECT_EQ(a.joint[0], -b.joint[0]);
}

TEST(PluginDevice, SaysWhatItsOpenSays) {
  const auto started = my_robot("both at zero")->start();
  ASSERT_FALSE(started);
  for (const char* const fact : {"two wheels", "'both at zero'"})
    EXPECT_NE(started.error().line().find(fact), std::string::npos) << started.error().line();
}

TEST(PluginDevice, BeginsAgain) {
  auto device = my_robot();
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(device->start());
    device::State state;
    EXPECT_TRUE(device->read(state));
    EXPECT_EQ(state.sequence, 1U);
    EXPECT_TRUE(device->write({0, {1.0, 1.0}, true}));
  }
}

TEST(PluginDevice, IsBrokenBeforeItIsStarted) {
  auto device = my_robot();
  device::State state;
  EXPECT_FALSE(device->read(state));
  EXPECT_FALSE(device->write({}));
  device->stop();
}

TEST(PluginDevice, DoesNotAllocateWhileItRuns) {
  auto device = my_robot();
  ASSERT_TRUE(device->start());
  device::State state;
  const long before = testing_support::allocations();
  for (std::uint64_t i = 0; i < 100; ++i) {
    device->read(state);
    device->write({i, {0.1, 0.1}, true});
  }
  EXPECT_EQ(testing_support::allocations(), before);
}

TEST(PluginDevice, NamesWhatIsMissing) {
  EXPECT_NE(refusal("/nowhere/robot.so").find("/nowhere/robot.so"), std::string::npos);
  EXPECT_NE(refusal(MBK_PLUGIN_WITHOUT_ENTRY).find("mbk_device_plugin_get"), std::string::npos);
  EXPECT_NE(refusal(MBK_PLUGIN_OTHER_VERSION).find("version 3"), std::string::npos);
  EXPECT_NE(refusal(MBK_PLUGIN_OTHER_SIZE).find("8 bytes"), std::string::npos);
  EXPECT_NE(refusal(MBK_PLUGIN_WITHOUT_FUNCTIONS).find("read, close"), std::string::npos);
  EXPECT_NE(refusal(MBK_MY_ROBOT).find("has_force"), std::string::npos);
}

TEST(PluginDevice, ReportsWhatItsDriverSaysOfTheMotors) {
  auto device = my_robot();
  EXPECT_TRUE(device->facts().acknowledges);
  ASSERT_TRUE(device->start());
  device::State state;
  ASSERT_TRUE(device->write({77, {0.1, 0.0}, true}));  // counted from its start, whatever the tick
  ASSERT_TRUE(device->read(state));
  EXPECT_EQ(state.answered, 1U);
  EXPECT_EQ(state.motors, device::Motors::on);
  device->stop();
  ASSERT_TRUE(device->read(state));
  EXPECT_EQ(state.answered, 2U);
  EXPECT_EQ(state.motors, device::Motors::off);
}

TEST(PluginDevice, OfVersionOneIsTakenAndConfirmsNothing) {
  PluginOptions options;
  options.library = MBK_PLUGIN_VERSION_ONE;
  const auto device = PluginDevice::create(options, {});
  ASSERT_TRUE(device) << device.error().line();
  EXPECT_FALSE((*device)->facts().acknowledges);
}

TEST(PluginDevice, WantsASample) {
  auto device = PluginDevice::create({MBK_PLUGIN_WITHOUT_SAMPLES, ""}, {}).value();
  const auto started = device->start();
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().line().find("sample"), std::string::npos);
}

}  // namespace
}  // namespace mbk::drivers
