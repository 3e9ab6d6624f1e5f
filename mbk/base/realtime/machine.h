#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/realtime/cycle_record.h"
#include "mbk/base/realtime/thread_setup.h"

namespace mbk::realtime {

/// Properties of a computer that determine how punctually it wakes a thread. Empty: unknown.
struct Machine {
  std::string kernel;                  ///< its version, as printed by uname -v
  std::optional<bool> preempt_rt;      ///< the kernel was built with PREEMPT_RT
  std::vector<std::string> governors;  ///< frequency governors of the processors, each once
  std::optional<double> idle_latency;  ///< longest wake-up latency of an enabled idle state [s]
  std::optional<std::uint64_t> swap;   ///< of all swap areas [bytes]
  std::optional<double> timer_slack;   ///< of a thread without real-time scheduling [s]
  std::optional<bool> virtual_machine;
  std::optional<double> processor_quota;  ///< quota of the control group, in processors
  std::string clock_source;               ///< "tsc"
  unsigned processors = 0;                ///< for this process
  std::optional<double> load;             ///< load average over one minute
};

/// @param root  where /proc and /sys are found
[[nodiscard]] Machine read_machine(const std::filesystem::path& root = "/");

/// Lateness of the wake-ups of a loop.
struct Lateness {
  /// Upper edges of the histogram [s], 1 µs … 0.1 s; one more count is for larger values.
  static constexpr std::array kEdges = {1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4,
                                        5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 1e-1};
  double period = 0.0;    ///< [s]
  double duration = 0.0;  ///< [s]
  int priority = 0;       ///< requested
  ThreadSetup setup;      ///< granted
  CycleRecord record;     ///< of the wake-ups [ns]
  std::array<std::uint64_t, kEdges.size() + 1> histogram{};
  std::uint64_t missed = 0;  ///< ticks without a wake-up

  void add(double late) noexcept;
};

/// As cyclictest does: a thread of its own sleeps until absolute times, one period apart. At the end no memory of the
/// process is locked.
/// @param period  [s] > 0   @param duration  [s] > 0   @param priority  1–99, as a session's loop asks for
[[nodiscard]] Lateness measure_lateness(double period, double duration, int priority = 80);

}  // namespace mbk::realtime
