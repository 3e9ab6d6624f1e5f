/// The 1 kHz session: an hour of it on the virtual clock with its recording and its memory, and a segment in real time
/// beside an empty loop, which shows how late this machine wakes any thread.
///   bench_session [--minutes 60] [--seconds 20, at least 5] [--out FOLDER]
#include "mbk/experiment/session/session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "mbk/simulate/laboratory/simulation.h"

namespace {

namespace fs = std::filesystem;
using namespace mbk;
using realtime::CycleRecord;
using realtime::monotonic_ns;

constexpr double kMiB = 1024.0 * 1024.0;

/// Memory of this process [MiB]; "VmRSS" now, "VmHWM" at most.
double memory(std::string_view key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return std::strtod(line.c_str() + key.size() + 1, nullptr) / 1024.0;
  }
  return 0.0;
}

/// The simulated robot with the time that it takes, tick by tick.
class TimedDevice : public device::Device {
 public:
  TimedDevice(device::Device& robot, std::size_t ticks) : robot_(&robot), took_(ticks) {}
  [[nodiscard]] const device::Facts& facts() const override { return robot_->facts(); }
  [[nodiscard]] Result<void> start() override { return robot_->start(); }
  bool read(device::State& state) noexcept override {
    const std::int64_t begin = monotonic_ns();
    const bool fine = robot_->read(state);
    reading_ = monotonic_ns() - begin;
    return fine;
  }
  bool write(const device::Command& command) noexcept override {
    const std::int64_t begin = monotonic_ns();
    const bool fine = robot_->write(command);
    const std::int64_t took = reading_ + monotonic_ns() - begin;
    times_.add(took);
    took_[command.tick % took_.size()] = took;
    return fine;
  }
  void stop() noexcept override { robot_->stop(); }
  [[nodiscard]] const CycleRecord& times() const { return times_; }
  [[nodiscard]] std::int64_t took(std::uint64_t tick) const { return took_[tick % took_.size()]; }

 private:
  device::Device* robot_;
  std::int64_t reading_ = 0;
  CycleRecord times_;
  std::vector<std::int64_t> took_;  // [ns] ring
};

std::string experiment(double seconds) {
  return fmt::format(R"(
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = {}
[participant]
kind = "arm"
number = 1
)",
                     seconds);
}

void print(const char* what, const CycleRecord& record) {
  fmt::print("  {:<42}{:>9.2f}{:>9.2f}{:>10.2f}\n", what, 1e-3 * record.quantile(0.5), 1e-3 * record.quantile(0.999),
             1e-3 * static_cast<double>(record.worst()));
}

/// Wakes up as the loop does, and does nothing.
CycleRecord empty_loop(const std::atomic<bool>& over) {
  [[maybe_unused]] const auto setup = realtime::prepare_thread();
  CycleRecord lateness;
  realtime::WallClock clock(1e-3);
  clock.start();
  while (!over) lateness.add(static_cast<std::int64_t>(1e9 * clock.wait()));
  return lateness;
}

/// Runs a trial and prints what it took.   @returns  whether nothing was dropped and memory stayed flat
bool perform(double seconds, bool real_time, const fs::path& folder) {
  const auto trial =
      protocol::read_experiment(experiment(seconds), "bench.toml", laboratory::read_simulation).value().front();
  const auto plan = session::make_plan(trial).value();
  const auto robot = laboratory::simulated_robot(trial).value();
  constexpr std::size_t kRing = 1 << 16;
  TimedDevice device(*robot, kRing);
  CycleRecord own;
  const double before = memory("VmRSS");
  const auto ticks = static_cast<std::uint64_t>(1000.0 * seconds);
  std::array<double, 3> resident{};
  const std::array<std::uint64_t, 3> when = {ticks / 10, ticks / 2, ticks};
  const auto watch = [&](std::span<const journal::Tick> came) {
    for (const journal::Tick& tick : came) {
      // what a tick took stands in the next
      if (tick.number > 0)
        own.add(std::llround(1e9 * static_cast<double>(tick.compute)) - device.took(tick.number - 1));
    }
    for (std::size_t i = 0; i < when.size(); ++i) {
      if (resident[i] == 0.0 && came.back().number >= when[i]) resident[i] = memory("VmRSS");
    }
  };
  session::Session session({.virtual_clock = !real_time, .speed = 0.0});
  std::atomic<bool> over{false};
  CycleRecord noise;
  std::optional<std::thread> empty;
  if (real_time) empty.emplace([&] { noise = empty_loop(over); });
  const fs::path target = folder / "bench_session.h5";
  const std::int64_t begin = monotonic_ns();
  const auto outcome = session.perform(device, plan, target, watch);
  const double took = 1e-9 * static_cast<double>(monotonic_ns() - begin);
  over = true;
  if (empty) empty->join();
  if (!outcome) {
    fmt::print("{}\n", outcome.error().line());
    return false;
  }
  fmt::print("{} ticks, {}: {}, {} dropped, {} missed; {:.1f} s with the recording made\n", outcome->times.ticks,
             real_time ? "real time" : "virtual clock", outcome->ended, outcome->ending.dropped, outcome->times.missed,
             took);
  fmt::print("  {:<42}{:>9}{:>9}{:>10}\n", "µs", "median", "p99.9", "worst");
  print("a tick from wake-up to end", outcome->times.compute);
  print("  of it the simulated robot", device.times());
  print("  of it the loop itself", own);
  if (real_time) {
    print("lateness of the loop", outcome->times.lateness);
    print("lateness of an empty loop at the same time", noise);
    if (!outcome->setup.refused.empty()) fmt::print("  {}\n", outcome->setup.refused);
  }
  fmt::print("  memory: {:.1f} MiB before, {:.1f} at 10 %, {:.1f} at 50 %, {:.1f} at 100 %\n", before, resident[0],
             resident[1], resident[2]);
  fmt::print("  journal {:.1f} MiB, recording {:.1f} MiB; at most {:.1f} MiB of memory, to make the recording\n",
             static_cast<double>(outcome->times.ticks * sizeof(journal::Tick)) / kMiB,
             static_cast<double>(fs::file_size(target)) / kMiB, memory("VmHWM"));
  fs::remove(target);
  constexpr double kFlat = 4.0;  // [MiB]
  return outcome->ending.dropped == 0 && resident[2] - resident[0] < kFlat;
}

}  // namespace

int main(int argc, char** argv) {
  double minutes = 60.0, seconds = 20.0;
  fs::path folder = fs::temp_directory_path();
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--minutes") minutes = std::strtod(argv[i + 1], nullptr);
    if (option == "--seconds") seconds = std::strtod(argv[i + 1], nullptr);
    if (option == "--out") folder = argv[i + 1];
  }
  const bool real = perform(seconds, true, folder);
  const bool hour = perform(60.0 * minutes, false, folder);
  return real && hour ? 0 : 1;
}
