// mbk_misbehaving_robot SCENARIO --fault NAME: a simulated robot behind UDP that misbehaves, and says what it truly
// did.
#include "mbk/validate/misbehaving_robot.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <string>

#include "mbk/base/realtime/thread_setup.h"
#include "mbk/simulate/laboratory/find_scenario.h"
#include "mbk/simulate/laboratory/simulated_device.h"
#include "mbk/validate/robot_event.h"
#include "mbk/validate/rule_breakers.h"
#include "mbk/validate/udp_fault_kinds.h"

namespace {

using namespace mbk;
using validation::RobotTruth;

constexpr char kHelp[] =
    "A simulated robot over UDP that develops a fault, for testing 'mbk run' and your own programs.\n"
    "It runs at its own clock of 1 kHz. Each line on standard output is a JSON object of the true state: ticks of its\n"
    "clock since the first greeting, monotonic time, and the state of its motors whatever the robot reports. The last\n"
    "object is 'end', after SIGTERM or Ctrl-C.\n"
    "With --breaks its program breaks a rule of the link from the beginning, for 'mbk robot check --link' to find; it\n"
    "prints only the address that it listens at.\n"
    "Examples:\n"
    "  mbk_misbehaving_robot relaxed_sinusoidal --fault latched-frozen-answer --at 2 --port 25000\n"
    "  mbk_misbehaving_robot relaxed_sinusoidal --breaks no-watchdog";

validation::MisbehavingRobot* serving = nullptr;

std::atomic<bool> over{false};

void end(int) {
  over = true;
  if (serving != nullptr) serving->end();
}

void end_by_signal(unsigned longest) {
  std::signal(SIGINT, end);
  std::signal(SIGTERM, end);
  std::signal(SIGALRM, end);
  alarm(longest);
}

void print(const std::string& line) {
  std::fputs(line.c_str(), stdout);
  std::fflush(stdout);
}

void say(std::string_view event, const RobotTruth& truth) {
  print(validation::event_line(event, truth));
}

int report(const Error& error) {
  fmt::print(stderr, "mbk_misbehaving_robot: {}\n", error.line());
  return 1;
}

void list() {
  for (const validation::UdpFaultKind& kind : validation::udp_fault_kinds()) {
    fmt::print("{:<26} {}\n", kind.name, kind.what);
  }
  fmt::print("\n--breaks:\n");
  for (const validation::RuleBreaker& one : validation::rule_breakers()) fmt::print("{:<26} {}\n", one.name, one.what);
}

struct Arguments {
  std::string scenario, trial, fault, breaks, address = "127.0.0.1";
  std::uint16_t port = 25000;
  std::uint16_t version = 0;
  double at = 1.0;
  std::uint64_t seed = 1;
  unsigned longest = 120;
  bool list = false;
};

int run(const Arguments& arguments) {
  auto scenario = laboratory::find_scenario(arguments.scenario, arguments.trial);
  if (!scenario) return report(scenario.error());
  scenario->seed = arguments.seed;
  validation::RobotFault fault;
  validation::MisbehavingRobot::Options options;
  if (!arguments.fault.empty()) {
    const validation::UdpFaultKind* kind = validation::find_udp_fault(arguments.fault);
    if (kind == nullptr) {
      return report({ErrorKind::usage, "'" + arguments.fault + "' is not a fault", "see --list", ""});
    }
    numeric::Random random(arguments.seed);
    kind->make(fault, random);
    options.version = kind->version;
  }
  const auto robot = laboratory::SimulatedDevice::create(*scenario);
  if (!robot) return report(robot.error());
  const auto local = drivers::UdpAddress::find(arguments.address, arguments.port);
  if (!local) return report(local.error());
  options.local = *local;
  options.sample_time = 1.0 / scenario->rate.value;
  if (arguments.version != 0) options.version = arguments.version;
  options.moment = arguments.at;
  options.seed = arguments.seed;
  auto served = validation::MisbehavingRobot::create(**robot, std::move(fault), options, say);
  if (!served) return report(served.error());
  serving = served->get();
  end_by_signal(arguments.longest);
  print(validation::listening_line(arguments.address, serving->local().port));
  serving->serve();
  say("end", serving->truth());
  return 0;
}

/// A robot whose program breaks a rule of the link.
int run_breaker(const Arguments& arguments) {
  const validation::RuleBreaker* breaker = validation::find_rule_breaker(arguments.breaks);
  if (breaker == nullptr) {
    return report({ErrorKind::usage, "'" + arguments.breaks + "' is not a rule to break", "see --list", ""});
  }
  const auto scenario = laboratory::find_scenario(arguments.scenario, arguments.trial);
  if (!scenario) return report(scenario.error());
  const auto robot = laboratory::SimulatedDevice::create(*scenario);
  if (!robot) return report(robot.error());
  const auto local = drivers::UdpAddress::find(arguments.address, arguments.port);
  if (!local) return report(local.error());
  validation::SpoiltLink link(breaker->make());
  auto served = drivers::UdpRobot::create(**robot, *local, 1.0 / scenario->rate.value, &link);
  if (!served) return report(served.error());
  end_by_signal(arguments.longest);
  print(validation::listening_line(arguments.address, served->local().port));
  (void)realtime::prepare_thread();  // where that is refused it is held up more often
  const std::atomic<bool> no_button{false};
  served->serve(over, no_button);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kHelp, "mbk_misbehaving_robot");
  Arguments arguments;
  CLI::Option* const scenario =
      app.add_option("SCENARIO", arguments.scenario, "a .toml file, or the name of a built-in scenario");
  app.add_option("--trial", arguments.trial, "the [[trial]] of the file (default: the first)");
  CLI::Option* const fault = app.add_option("--fault", arguments.fault, "name of the fault (default: none)");
  app.add_option("--breaks", arguments.breaks, "name of the rule of the link that its program breaks")->excludes(fault);
  app.add_option("--at", arguments.at, "time of the fault, in seconds after the motors first switch on (default: 1)");
  app.add_option("--seed", arguments.seed, "random seed of fault, noise and participant (default: 1)");
  app.add_option("--address", arguments.address, "IP address that it listens at (default: 127.0.0.1)");
  app.add_option("--port", arguments.port, "UDP port that it listens at; 0: any free port (default: 25000)");
  app.add_option("--version", arguments.version,
                 "protocol version of its states: 1 or 2 (default: as the fault needs)");
  app.add_option("--for", arguments.longest, "exit after N seconds (default: 120)");
  CLI::Option* const table = app.add_flag("--list", arguments.list, "list the faults and the rules to break");
  scenario->excludes(table);
  CLI11_PARSE(app, argc, argv);
  if (arguments.list) {
    list();
    return 0;
  }
  if (scenario->empty()) {
    fmt::print(stderr, "mbk_misbehaving_robot: SCENARIO is missing; see --help\n");
    return 2;
  }
  return arguments.breaks.empty() ? run(arguments) : run_breaker(arguments);
}
