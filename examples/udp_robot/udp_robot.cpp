// mbk_udp_robot SCENARIO: a simulated robot with a participant at its handle, reached by UDP as a real one would be.
#include "mbk/experiment/drivers/udp_robot.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <string>

#include "mbk/base/realtime/thread_setup.h"
#include "mbk/simulate/laboratory/find_scenario.h"
#include "mbk/simulate/laboratory/simulated_device.h"

namespace {

using namespace mbk;

constexpr char kHelp[] =
    "A simulated robot that is reached by UDP, to try 'mbk run' and your own programs on.\n"
    "It runs at its own clock of 1 kHz; where [device] says lock_step = true it waits for each command.\n"
    "SIGUSR1 presses its stop button and releases it again; Ctrl-C ends it.\n"
    "Example: mbk_udp_robot rigid_sinusoidal_6N --port 25000";

std::atomic<bool> over{false}, stop_button{false};

int report(const Error& error) {
  fmt::print(stderr, "mbk_udp_robot: {}\n", error.line());
  return 1;
}

int run(const std::string& name, const std::string& trial, const std::string& address, std::uint16_t port) {
  const auto scenario = laboratory::find_scenario(name, trial);
  if (!scenario) return report(scenario.error());
  const auto robot = laboratory::SimulatedDevice::create(*scenario);
  if (!robot) return report(robot.error());
  const auto local = drivers::UdpAddress::find(address, port);
  if (!local) return report(local.error());
  auto served = drivers::UdpRobot::create(**robot, *local, 1.0 / scenario->rate.value);
  if (!served) return report(served.error());
  fmt::print("listening at UDP {}\n", served->local().text());
  std::fflush(stdout);
  (void)realtime::prepare_thread();  // as a robot's own program has to; where that is refused it is held up more often
  served->serve(over, stop_button);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, [](int) { over = true; });
  std::signal(SIGTERM, [](int) { over = true; });
  std::signal(SIGUSR1, [](int) { stop_button = !stop_button; });
  CLI::App app(kHelp, "mbk_udp_robot");
  std::string name, trial, address = "127.0.0.1";
  std::uint16_t port = 25000;
  app.add_option("SCENARIO", name, "a .toml file, or the name of a ready one")->required();
  app.add_option("--trial", trial, "this [[trial]] of the file; the first without it");
  app.add_option("--address", address, "of the network where it listens; 0.0.0.0 for all (127.0.0.1)");
  app.add_option("--port", port, "where it listens; 0 for any that is free (25000)");
  CLI11_PARSE(app, argc, argv);
  return run(name, trial, address, port);
}
