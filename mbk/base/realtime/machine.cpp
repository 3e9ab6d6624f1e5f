#include "mbk/base/realtime/machine.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "mbk/base/realtime/clock.h"
#include "mbk/base/system/process.h"

namespace mbk::realtime {
namespace {

namespace fs = std::filesystem;

/// The whole of a small file of /proc or /sys; nothing where it cannot be read.
std::optional<std::string> text_of(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::optional<double> number_in(const fs::path& file) {
  const auto text = text_of(file);
  double value = 0.0;
  if (!text || !(std::istringstream(*text) >> value)) return std::nullopt;
  return value;
}

std::vector<fs::path> entries(const fs::path& folder, const std::string& begin) {
  std::vector<fs::path> found;
  std::error_code error;
  for (auto at = fs::directory_iterator(folder, error); !error && at != fs::directory_iterator(); at.increment(error)) {
    if (at->path().filename().string().starts_with(begin)) found.push_back(at->path());
  }
  return found;
}

/// The sum of the sizes; the first line names the columns.
std::optional<std::uint64_t> swap_of(const fs::path& proc) {
  std::ifstream stream(proc / "swaps");
  std::string line;
  if (!std::getline(stream, line)) return std::nullopt;
  std::uint64_t kilobytes = 0;
  while (std::getline(stream, line)) {
    std::string name, type;
    std::uint64_t size = 0;
    if (std::istringstream(line) >> name >> type >> size) kilobytes += size;
  }
  return 1024 * kilobytes;
}

/// Over all processors: the longest latency of a state that is not disabled.
std::optional<double> idle_latency_of(const fs::path& cpus) {
  std::optional<double> longest;
  for (const fs::path& cpu : entries(cpus, "cpu")) {
    for (const fs::path& state : entries(cpu / "cpuidle", "state")) {
      const auto latency = number_in(state / "latency");
      if (latency && number_in(state / "disable").value_or(0.0) == 0.0) {
        longest = std::max(longest.value_or(0.0), 1e-6 * *latency);
      }
    }
  }
  return longest;
}

/// "0::/user.slice/…" names the group; "50000 100000" is half a processor.
std::optional<double> quota_of(const fs::path& root) {
  const auto group = text_of(root / "proc/self/cgroup");
  if (!group) return std::nullopt;
  const std::size_t at = group->find("0::/");
  if (at == std::string::npos) return std::nullopt;
  const std::string name = group->substr(at + 4, group->find('\n', at) - at - 4);
  std::optional<double> least;
  for (fs::path folder = name;; folder = folder.parent_path()) {
    double allowed = 0.0, period = 0.0;
    const auto text = text_of(root / "sys/fs/cgroup" / folder / "cpu.max");
    if (text && std::istringstream(*text) >> allowed >> period && period > 0.0) {
      least = std::min(least.value_or(allowed / period), allowed / period);
    }
    if (folder.empty()) return least;
  }
}

}  // namespace

Machine read_machine(const fs::path& root) {
  Machine machine;
  const fs::path proc = root / "proc", cpus = root / "sys/devices/system/cpu";
  machine.kernel = text_of(proc / "sys/kernel/version").value_or("");
  if (!machine.kernel.empty()) {
    machine.preempt_rt = machine.kernel.find("PREEMPT_RT") != std::string::npos ||
                         number_in(root / "sys/kernel/realtime").value_or(0.0) == 1.0;
  }
  std::set<std::string> governors;
  for (const fs::path& cpu : entries(cpus, "cpu")) {
    if (auto governor = text_of(cpu / "cpufreq/scaling_governor")) governors.insert(*governor);
  }
  machine.governors.assign(governors.begin(), governors.end());
  machine.idle_latency = idle_latency_of(cpus);
  machine.swap = swap_of(proc);
  if (const auto slack = number_in(proc / "self/timerslack_ns")) machine.timer_slack = 1e-9 * *slack;
  if (const auto info = text_of(proc / "cpuinfo")) {
    machine.virtual_machine = info->find(" hypervisor") != std::string::npos;
  }
  machine.processor_quota = quota_of(root);
  machine.clock_source = text_of(root / "sys/devices/system/clocksource/clocksource0/current_clocksource").value_or("");
  machine.processors = system::usable_processors();
  machine.load = number_in(proc / "loadavg");
  return machine;
}

void Lateness::add(double late) noexcept {
  record.add(std::llround(1e9 * late));
  const auto edge = std::ranges::lower_bound(kEdges, late);
  ++histogram[static_cast<std::size_t>(edge - kEdges.begin())];
}

Lateness measure_lateness(double period, double duration, int priority) {
  Lateness found;
  found.period = period;
  found.priority = priority;
  std::thread([&] {
    found.setup = prepare_thread(priority);
    WallClock clock(period);
    clock.start();
    while (clock.now() < duration) found.add(clock.wait());
    found.duration = clock.now();
    found.missed = clock.missed();
  }).join();
  if (found.setup.locked_memory) unlock_memory();  // who called may need more of it than may be locked
  return found;
}

}  // namespace mbk::realtime
