// mbk_udp_robot SCENARIO: a simulated robot with a participant at its handle, connected by UDP like a real robot.
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
    "A simulated robot connected by UDP, for trying 'mbk run' and your own programs.\n"
    "It runs on its own 1 kHz clock; with lock_step = true in [device] it waits for each command.\n"
    "SIGUSR1 presses and releases its stop button; Ctrl-C ends it.\n"
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
  (void)realtime::prepare_thread();  // a robot program must do this too; without permission it is delayed more often
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
  app.add_option("SCENARIO", name, ".toml file or name of a built-in scenario")->required();
  app.add_option("--trial", trial, "name of the [[trial]] to use (default: the first)");
  app.add_option("--address", address, "IP address to listen on; 0.0.0.0 for all (default: 127.0.0.1)");
  app.add_option("--port", port, "UDP port to listen on; 0 for any free port (default: 25000)");
  CLI11_PARSE(app, argc, argv);
  return run(name, trial, address, port);
}
