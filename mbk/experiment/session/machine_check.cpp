#include "mbk/experiment/session/machine_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "mbk/experiment/safety/limits.h"

namespace mbk::session {
namespace {

using realtime::Lateness;
using realtime::Machine;
using Verdict = Finding::Verdict;

constexpr double kMuchLateness = 0.25;      // of a tick, for one wake-up in a thousand
constexpr double kLongIdle = 1e-4;          // [s]
constexpr std::size_t kBar = 40;            // columns
constexpr std::uint64_t kManyTicks = 5000;  // fewer say little of one in a thousand

std::string time_text(double seconds) {
  return seconds < 1e-3 ? fmt::format("{:.3g} µs", 1e6 * seconds) : fmt::format("{:.3g} ms", 1e3 * seconds);
}

double quantile(const Lateness& lateness, double share) {
  return 1e-9 * lateness.record.quantile(share);
}

double worst_of(const Lateness& lateness) {
  return 1e-9 * static_cast<double>(lateness.record.worst());
}

Finding judge(Verdict verdict, const std::string& text, const std::string& remedy) {
  return {verdict, verdict == Verdict::fine ? text : text + "; " + remedy};
}

/// The measurement itself.
void check_lateness(const Lateness& lateness, std::vector<Finding>& findings) {
  const double longest = safety::Limits{}.lateness, worst = worst_of(lateness);
  const std::string measured =
      fmt::format("in {:.3g} s no wake-up was later than {}", lateness.duration, time_text(worst));
  if (worst >= longest) {
    findings.push_back(judge(
        Verdict::wrong,
        fmt::format("a wake-up was {} late; a trial stops at {} by default", time_text(worst), time_text(longest)),
        "correct the points below, and end other programs"));
  } else if (lateness.missed > 0) {
    findings.push_back(judge(Verdict::doubtful,
                             fmt::format("{} of {} ticks were missed, the latest by {}", lateness.missed,
                                         lateness.missed + lateness.record.count(), time_text(worst)),
                             "correct the points below, and end other programs"));
  } else {
    findings.push_back(
        judge(quantile(lateness, 0.999) <= kMuchLateness * lateness.period ? Verdict::fine : Verdict::doubtful,
              measured, "one in a thousand was late by more than a quarter of a tick"));
  }
  if (lateness.record.count() < kManyTicks) {
    findings.push_back(
        {Verdict::doubtful, fmt::format("{} ticks are too few to judge one in a thousand; measure longer, as "
                                        "--rt 60",
                                        lateness.record.count())});
  }
}

void check_thread(const Lateness& lateness, std::vector<Finding>& findings) {
  const realtime::ThreadSetup& setup = lateness.setup;
  if (setup.fifo) {
    findings.push_back({Verdict::fine, fmt::format("real-time scheduling (SCHED_FIFO {})", lateness.priority)});
  }
  if (setup.locked_memory) findings.push_back({Verdict::fine, "memory is locked"});
  if (!setup.refused.empty()) findings.push_back({Verdict::doubtful, setup.refused});
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void check_processors(const Machine& machine, std::vector<Finding>& findings) {
  const auto add = [&](bool fine, const std::string& text, const char* remedy) {
    findings.push_back(judge(fine ? Verdict::fine : Verdict::doubtful, text, remedy));
  };
  if (!machine.governors.empty()) {
    const bool fine = std::ranges::all_of(machine.governors, [](const auto& one) { return one == "performance"; });
    add(fine, "frequency governor: " + joined(machine.governors),
        "sudo cpupower frequency-set -g performance (Debian: linux-cpupower)");
  }
  if (machine.idle_latency) {
    add(*machine.idle_latency <= kLongIdle,
        fmt::format("processors need up to {} to wake from idle states", time_text(*machine.idle_latency)),
        "sudo cpupower idle-set -D 50, or processor.max_cstate=1 on the kernel command line");
  }
  if (machine.preempt_rt) {
    add(*machine.preempt_rt, *machine.preempt_rt ? "kernel with PREEMPT_RT" : "kernel without PREEMPT_RT",
        "if wake-ups are late, install linux-image-rt-amd64");
  }
  if (machine.processor_quota) {
    add(false, fmt::format("the control group allows {:.3g} processors", *machine.processor_quota),
        "run mbk outside the container, or without cpu.max");
  }
  if (machine.load && machine.processors > 0) {
    add(*machine.load < 0.5 * machine.processors,
        fmt::format("load {:.2f} on {} processors", *machine.load, machine.processors),
        "other programs are running: end them, or keep a processor free (isolcpus)");
  }
}

void check_system(const Machine& machine, bool fifo, bool locked, std::vector<Finding>& findings) {
  if (machine.virtual_machine && *machine.virtual_machine) {
    findings.push_back({Verdict::doubtful,
                        "this is a virtual machine: its host may delay it at any time, which no measurement of a few "
                        "seconds excludes; run a robot from real hardware"});
  }
  if (machine.swap && *machine.swap > 0) {
    findings.push_back(judge(locked ? Verdict::fine : Verdict::doubtful,
                             fmt::format("{:.3g} GB of swap{}", 1e-9 * static_cast<double>(*machine.swap),
                                         locked ? ", which does not affect locked memory" : ""),
                             "sudo swapoff -a, or allow mbk to lock its memory"));
  }
  if (machine.timer_slack && !fifo) {
    findings.push_back(judge(Verdict::doubtful, "timer slack " + time_text(*machine.timer_slack),
                             "allow real-time scheduling, which removes it"));
  }
  const auto slow = {"hpet", "acpi_pm", "jiffies", "refined-jiffies"};
  if (std::ranges::find(slow, machine.clock_source) != slow.end()) {
    findings.push_back({Verdict::doubtful, fmt::format("the clock source '{}' is slow to read; the kernel's log "
                                                       "shows why it is not tsc",
                                                       machine.clock_source)});
  }
}

}  // namespace

std::vector<Finding> check_machine(const Machine& machine, const Lateness& lateness) {
  std::vector<Finding> findings;
  check_lateness(lateness, findings);
  check_thread(lateness, findings);
  check_processors(machine, findings);
  check_system(machine, lateness.setup.fifo, lateness.setup.locked_memory, findings);
  return findings;
}

std::string lateness_text(const Machine& machine, const Lateness& lateness) {
  std::string text = fmt::format(
      "wake-ups at {:g} Hz for {:.3g} s, {}\n"
      "  late by    median {}, 99.9 % within {}, at most {}\n"
      "  missed     {} of {} ticks\n",
      1.0 / lateness.period, lateness.duration,
      lateness.setup.fifo ? fmt::format("SCHED_FIFO {}", lateness.priority) : "without real-time scheduling",
      time_text(quantile(lateness, 0.5)), time_text(quantile(lateness, 0.999)), time_text(worst_of(lateness)),
      lateness.missed, lateness.missed + lateness.record.count());
  const auto& counts = lateness.histogram;
  const auto highest = static_cast<double>(std::max<std::uint64_t>(*std::ranges::max_element(counts), 1));
  std::size_t last = counts.size();
  while (last > 1 && counts[last - 1] == 0) --last;
  for (std::size_t i = 0; i < last; ++i) {
    const bool open = i == Lateness::kEdges.size();
    const auto bar = static_cast<std::size_t>(std::ceil(kBar * static_cast<double>(counts[i]) / highest));
    const std::string upper = time_text(Lateness::kEdges[open ? i - 1 : i]);
    text += fmt::format("  {} {:>7} {:>9}{}{}\n", open ? "> " : "to", upper, counts[i], bar > 0 ? "  " : "",
                        std::string(bar, '#'));
  }
  if (!machine.kernel.empty()) text += fmt::format("  kernel     {}\n", machine.kernel);
  return text;
}

}  // namespace mbk::session
