#include "mbk/base/realtime/machine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>

namespace mbk::realtime {
namespace {

/// A folder that looks like / to whoever asks for /proc and /sys.
class MachineTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "mbk-machine-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  void put(const std::string& file, const std::string& text) {
    std::filesystem::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text << "\n";
  }

  std::filesystem::path root_;
};

TEST_F(MachineTest, WhereNothingIsSaidNothingIsKnown) {
  const Machine machine = read_machine(root_);
  EXPECT_FALSE(machine.preempt_rt || machine.idle_latency || machine.swap || machine.timer_slack ||
               machine.virtual_machine || machine.processor_quota || machine.load);
  EXPECT_TRUE(machine.governors.empty());
}

TEST_F(MachineTest, ReadsWhatTheKernelSays) {
  put("proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian 6.1.140-1");
  put("proc/swaps", "Filename Type Size Used Priority\n/dev/sda2 partition 1000 0 -2\n/swapfile file 24 0 -3");
  put("proc/self/timerslack_ns", "50000");
  put("proc/cpuinfo", "flags\t\t: fpu vme hypervisor lahf_lm");
  put("proc/loadavg", "1.25 0.5 0.1 1/100 4000");
  put("proc/self/cgroup", "0::/a.slice/b.scope");
  put("sys/fs/cgroup/a.slice/cpu.max", "50000 100000");
  put("sys/fs/cgroup/a.slice/b.scope/cpu.max", "max 100000");
  put("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc");
  for (const char* cpu : {"cpu0", "cpu1"}) {
    const std::string at = std::string("sys/devices/system/cpu/") + cpu;
    put(at + "/cpufreq/scaling_governor", cpu[3] == '0' ? "performance" : "powersave");
    put(at + "/cpuidle/state0/latency", "2");
    put(at + "/cpuidle/state1/latency", "130");
    put(at + "/cpuidle/state2/latency", "900");
    put(at + "/cpuidle/state2/disable", "1");
  }
  const Machine machine = read_machine(root_);
  EXPECT_TRUE(machine.preempt_rt.value());
  EXPECT_EQ(machine.swap.value(), 1024U * 1024U);
  EXPECT_DOUBLE_EQ(machine.timer_slack.value(), 5e-5);
  EXPECT_TRUE(machine.virtual_machine.value());
  EXPECT_EQ(machine.load.value(), 1.25);
  EXPECT_EQ(machine.processor_quota.value(), 0.5);
  EXPECT_EQ(machine.clock_source, "tsc");
  EXPECT_EQ(machine.governors, (std::vector<std::string>{"performance", "powersave"}));
  EXPECT_DOUBLE_EQ(machine.idle_latency.value(), 1.3e-4);
}

TEST_F(MachineTest, ARealMachineWithoutThem) {
  put("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC");
  put("proc/swaps", "Filename Type Size Used Priority");
  put("proc/cpuinfo", "flags\t\t: fpu vme");
  const Machine machine = read_machine(root_);
  EXPECT_FALSE(machine.preempt_rt.value());
  EXPECT_EQ(machine.swap.value(), 0U);
  EXPECT_FALSE(machine.virtual_machine.value());
}

TEST(LatenessTest, EveryWakeUpIsCountedOnce) {
  const Lateness found = measure_lateness(1e-3, 0.1);
  const auto all = std::accumulate(found.histogram.begin(), found.histogram.end(), std::uint64_t{0});
  EXPECT_EQ(all, found.record.count());
  EXPECT_GE(all + found.missed, 95U);
  EXPECT_GE(found.duration, 0.1);
  EXPECT_GE(static_cast<double>(found.record.worst()), found.record.quantile(0.5));
}

TEST(LatenessTest, BinsHoldTheirUpperEdge) {
  Lateness found;
  for (const double late : {0.0, 1e-6, 1.1e-6, 0.1, 0.2}) found.add(late);
  EXPECT_EQ(found.histogram.front(), 2U);
  EXPECT_EQ(found.histogram[1], 1U);
  EXPECT_EQ(found.histogram[Lateness::kEdges.size() - 1], 1U);
  EXPECT_EQ(found.histogram.back(), 1U);
}

}  // namespace
}  // namespace mbk::realtime
