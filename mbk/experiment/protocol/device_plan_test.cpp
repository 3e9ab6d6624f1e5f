#include "mbk/experiment/protocol/device_plan.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "mbk/experiment/protocol/experiment.h"

namespace mbk::protocol {
namespace {

constexpr double kPi = 3.141592653589793;

Result<std::vector<Trial>> read(const std::string& device) {
  return read_experiment(
      "[control]\nkind = \"position\"\n[perturbation]\nkind = \"none\"\n[robot]\nd1_mm = 254\n[device]\n" + device,
      "/lab/mine.toml");
}

DevicePlan plan(const std::string& device) {
  const auto trials = read(device);
  EXPECT_TRUE(trials) << trials.error().line();
  return trials ? trials->front().device : DevicePlan{};
}

std::string refusal(const std::string& device) {
  const auto trials = read(device);
  EXPECT_FALSE(trials) << device;
  return trials ? "" : trials.error().line();
}

TEST(DevicePlan, EveryLimitHasABound) {
  for (const safety::LimitKey& one : safety::limit_keys()) {
    const std::string section = fmt::format("[safety]\n{} = ", one.key);
    const bool both = one.key == "joint_torque_Nm";
    const std::string beyond = both ? "[1, 1e9]" : "1e9",
                      at = both ? fmt::format("[1, {}]", one.most) : fmt::format("{}", one.most);
    EXPECT_NE(refusal(section + beyond).find(one.why), std::string::npos) << one.key;
    EXPECT_TRUE(read(section + at)) << one.key;
    if (one.may_be_off) continue;
    EXPECT_FALSE(read(section + (both ? "[0, 1]" : "0"))) << one.key;
  }
}

TEST(DevicePlan, TheWorkspaceHasABoundToo) {
  safety::Limits limits;
  limits.workspace_low = {-1000.0, -1.0};
  EXPECT_FALSE(safety::check(limits));
  limits.workspace_low = {-1.5, -1.0};
  EXPECT_TRUE(safety::check(limits));
  EXPECT_EQ(safety::weakened(limits).size(), 1U);
}

TEST(DevicePlan, IsSimulatedWhereNothingIsSaid) {
  EXPECT_TRUE(plan("").simulated());
  EXPECT_TRUE(plan("kind = \"simulated\"\n").simulated());
}

TEST(DevicePlan, ReadsUdp) {
  const DevicePlan p = plan(
      "kind = \"udp\"\naddress = \"192.168.7.2\"\nport = 4000\nlocal_port = 4001\nwatchdog_ms = 20\n"
      "answer_within_s = 3\nlock_step = true\nhas_force = false\nhas_acceleration = false\nforce_latency_ticks = 2\n");
  const auto& udp = std::get<drivers::UdpOptions>(p.kind);
  EXPECT_EQ(udp.address, "192.168.7.2");
  EXPECT_EQ(udp.port, 4000);
  EXPECT_EQ(udp.local_port, 4001);
  EXPECT_EQ(udp.watchdog, 0.02);
  EXPECT_EQ(udp.answer_within, 3.0);
  EXPECT_TRUE(udp.lock_step);
  EXPECT_FALSE(p.fittings.has_force);
  EXPECT_FALSE(p.fittings.has_acceleration);
  EXPECT_EQ(p.fittings.force_latency, 2);
  EXPECT_FALSE(p.counts);
  EXPECT_EQ(p.fittings.wiring.radians_per_count, Eigen::Vector2d(1.0, 1.0));
}

TEST(DevicePlan, TakesALibraryFromTheExperimentsFolder) {
  const auto of = [](const std::string& name) {
    return std::get<drivers::PluginOptions>(plan("kind = \"plugin\"\nlibrary = \"" + name + "\"\n").kind).library;
  };
  EXPECT_EQ(of("build/mine.so"), "/lab/build/mine.so");
  EXPECT_EQ(of("/usr/lib/mine.so"), "/usr/lib/mine.so");
}

TEST(DevicePlan, ReadsTheWiring) {
  const DevicePlan p = plan(
      "kind = \"udp\"\n[device.wiring]\ncounts_per_turn = [4000, 8192]\nencoder_sign = [1, -1]\n"
      "count_offset = [100, -20]\nforce_gain_N_per_unit = [[2, 0.5], [0, 3]]\nforce_offset = [0.1, 0.2]\n"
      "force_frame = \"last_link\"\nforce_step = 0.001\nacceleration_gain_per_unit = [[9.81, 0], [0, -9.81]]\n"
      "acceleration_offset = [2.5, 2.5]\nacceleration_frame = \"last_link\"\n"
      "torque_per_command_Nm = [0.05, 0.06]\ngear = [20, 10]\nmotor_sign = [-1, 1]\n");
  const device::Wiring& w = p.fittings.wiring;
  EXPECT_TRUE(p.counts);
  EXPECT_DOUBLE_EQ(w.radians_per_count[0], 2.0 * kPi / 4000.0);
  EXPECT_DOUBLE_EQ(w.radians_per_count[1], -2.0 * kPi / 8192.0);
  EXPECT_EQ(w.count_offset, Eigen::Vector2d(100.0, -20.0));
  EXPECT_EQ(w.force_gain(0, 1), 0.5);
  EXPECT_EQ(w.force_offset, Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(w.force_frame, device::Wiring::Frame::last_link);
  EXPECT_EQ(p.force_step, 0.001);
  EXPECT_EQ(w.acceleration_gain(1, 1), -9.81);
  EXPECT_EQ(w.acceleration_offset, Eigen::Vector2d(2.5, 2.5));
  EXPECT_EQ(w.acceleration_frame, device::Wiring::Frame::last_link);
  EXPECT_DOUBLE_EQ(w.torque_per_command[0], -1.0);
  EXPECT_DOUBLE_EQ(w.torque_per_command[1], 0.6);
}

TEST(DevicePlan, RefusalsNameFileLineAndKey) {
  EXPECT_NE(refusal("kind = \"udp\"\nprot = 5\n").find("port"), std::string::npos);
  for (const char* const place : {"/lab/mine.toml", "line 9"})
    EXPECT_NE(refusal("kind = \"udp\"\nport = 70000\n").find(place), std::string::npos)
        << refusal("kind = \"udp\"\nport = 70000\n");
  EXPECT_NE(refusal("kind = \"can\"\n").find("udp"), std::string::npos);
  EXPECT_NE(refusal("kind = \"plugin\"\n").find("library"), std::string::npos);
  EXPECT_NE(refusal("kind = \"udp\"\nwatchdog_ms = 0\n").find("watchdog_ms"), std::string::npos);
  EXPECT_NE(refusal("[device.wiring]\ngear = [1, 1]\n").find("wiring"), std::string::npos);
  const std::string wiring = "kind = \"udp\"\n[device.wiring]\n";
  EXPECT_NE(refusal(wiring + "encoder_sign = [1, 2]\n").find("encoder_sign"), std::string::npos);
  EXPECT_NE(refusal(wiring + "counts_per_turn = [0, 4000]\n").find("counts_per_turn"), std::string::npos);
  EXPECT_NE(refusal(wiring + "force_gain_N_per_unit = [[1, 2], [2, 4]]\n").find("force_gain"), std::string::npos);
}

TEST(DevicePlan, MakesTheDeviceThatItNames) {
  const auto made = [](const std::string& device) { return make_device(read(device).value().front()); };
  EXPECT_EQ(made("kind = \"udp\"\nport = 4000\n").value()->facts().name, "UDP 127.0.0.1:4000");
  EXPECT_FALSE(made("kind = \"plugin\"\nlibrary = \"gone.so\"\n"));
  const auto nothing = made("");
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().line().find("robot"), std::string::npos);
}

}  // namespace
}  // namespace mbk::protocol
