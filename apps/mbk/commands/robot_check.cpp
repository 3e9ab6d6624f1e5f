#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <optional>
#include <string>

#include "apps/mbk/commands/robot_commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/experiment/session/live_check.h"
#include "mbk/experiment/session/machine_check.h"
#include "mbk/experiment/session/robot_check_report.h"
#include "mbk/simulate/laboratory/named_scenario.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace mbk::app {
namespace {

constexpr int kNotAllTested = 6;
constexpr double kSaySo = 2.0;  // a longer measurement is announced [s]

struct RobotCheckArguments {
  std::string file;
  std::optional<double> live, timing;
  std::string link;
  bool motors = false;
  double rate_hz = 1000.0;
  int local_port = 0;
  OutputArguments output;
};

/// "192.168.7.2:25000"; the port may be missing.
Result<drivers::UdpAddress> address_of(const std::string& given) {
  constexpr std::uint16_t kPort = 25000;
  const std::size_t colon = given.rfind(':');
  if (colon == std::string::npos) return drivers::UdpAddress::find(given, kPort);
  std::uint16_t port = 0;
  const char* const end = given.data() + given.size();
  const auto [at, error] = std::from_chars(given.data() + colon + 1, end, port);
  if (error != std::errc() || at != end || port == 0) {
    return bad_usage(fmt::format("--link {} has no port from 1 to 65535", quoted(given)),
                     "write it as 192.168.7.2:25000");
  }
  return drivers::UdpAddress::find(given.substr(0, colon), port);
}

Result<session::RobotCheckReport::Setup> check_setup(const RobotCheckArguments& arguments) {
  const auto text = MBK_TRY(laboratory::read_scenario_text(arguments.file));
  const auto setup = MBK_TRY(session::read_robot_setup(text.text, text.file, laboratory::read_simulation));
  if (arguments.live && !setup.has_device) {
    return tl::unexpected(Error{ErrorKind::usage, "the file names no robot to connect to",
                                "add [device], or omit --live", arguments.file});
  }
  session::RobotCheckReport::Setup found{
      arguments.file, session::setup_text(setup), session::check_setup(setup), "", {}};
  if (!arguments.live) return found;
  const auto robot = MBK_TRY(protocol::make_device(setup.trial));
  const auto record = MBK_TRY(session::watch_robot(*robot, setup.trial.rate, *arguments.live));
  found.live_text = session::live_text(setup, robot->facts(), record);
  found.live = session::check_live(setup, robot->facts(), record);
  return found;
}

Result<session::RobotCheckReport::Link> check_link(const RobotCheckArguments& arguments) {
  const auto robot = MBK_TRY(address_of(arguments.link));
  auto wire = MBK_TRY(drivers::UdpBridgeWire::open(robot, static_cast<std::uint16_t>(arguments.local_port)));
  drivers::BridgeCheckOptions options;
  options.rate = arguments.rate_hz;
  options.motors = arguments.motors;
  if (options.motors && !arguments.output.quiet) say("switching the motors of {} on, with command 0\n", robot.text());
  auto report = MBK_TRY(drivers::check_bridge(wire, options));
  return session::RobotCheckReport::Link{robot.text(), options, std::move(report)};
}

session::RobotCheckReport::Timing check_timing(const RobotCheckArguments& arguments) {
  if (*arguments.timing > kSaySo && !arguments.output.quiet) say("measuring for {:g} s\n", *arguments.timing);
  session::RobotCheckReport::Timing found{
      realtime::read_machine(), realtime::measure_lateness(1.0 / arguments.rate_hz, *arguments.timing), {}};
  found.findings = session::check_machine(found.machine, found.lateness);
  return found;
}

Result<session::RobotCheckReport> check_all(const RobotCheckArguments& arguments) {
  session::RobotCheckReport report;
  if (!arguments.file.empty()) {
    auto setup = MBK_TRY(check_setup(arguments));
    report.setup = std::move(setup);
  }
  if (!arguments.link.empty()) {
    auto link = MBK_TRY(check_link(arguments));
    report.link = std::move(link);
  }
  if (arguments.timing) report.timing = check_timing(arguments);
  return report;
}

int run(const RobotCheckArguments& arguments) {
  if (auto ok = arguments.output.to.check({}); !ok) return report_error(ok.error());
  if (arguments.file.empty() && arguments.link.empty() && !arguments.timing) {
    return report_error({ErrorKind::usage, "there is nothing to check",
                         "name a FILE, or pass --link ADDRESS or --rt; see 'mbk robot check --help'", ""});
  }
  const auto report = check_all(arguments);
  if (!report) return report_error(report.error());
  if (auto ok =
          arguments.output.to.write(arguments.output.json ? session::json_of(*report) : session::text_of(*report), {});
      !ok) {
    return report_error(ok.error());
  }
  return report->wrong() ? kNotUsable : report->incomplete() ? kNotAllTested : kFine;
}

}  // namespace

Action add_robot_check(Command group) {
  auto arguments = std::make_shared<RobotCheckArguments>();
  const Command command = group.add_command("check", "check the description, wiring and communication of a robot");
  command.footer(
      "Examples:\n"
      "  mbk robot check my_experiment.toml\n"
      "      shows geometry, limits, wiring and device as understood, and what is implausible\n"
      "  mbk robot check my_experiment.toml --live 5\n"
      "      also reads for five seconds with the motors off; turn the joints, press the stop button\n"
      "  mbk robot check --link 192.168.7.2:25000 --motors\n"
      "      tests whether the robot's program, such as your own bridge, follows every rule of the link\n"
      "  mbk robot check --rt 60\n"
      "      measures how punctually this computer wakes the control loop, and what delays it\n\n"
      "Run all of these before a participant sits down at a new robot. docs/guide/own_robot.md has a\n"
      "bridge to start from, the keys of [device] and the rules of the link.\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 the file cannot be read or the robot does not\n"
      "answer, 4 something is wrong, 6 not everything was tested.");
  const Option file = command
                          .add_option("FILE", arguments->file,
                                      "description of a robot, or an experiment: .toml, or the name of a built-in one")
                          .check(suggests(laboratory::ready_scenario_names()));
  command
      .add_option("--live", arguments->live,
                  "connect, and watch the readings for this time, in seconds, with the motors off (default: 2)")
      .type_name("S")
      .expected(0, 1)
      .default_str("2")
      .option_text("S")
      .check(positive())
      .needs(file);
  const Option link =
      command
          .add_option("--link", arguments->link,
                      "test a robot's program over UDP against every rule of the link (default port: 25000)")
          .type_name("ADDRESS")
          .check(not_empty());
  command
      .add_flag(
          "--motors", arguments->motors,
          "also test the rules that need its motors on, with command 0; keep everyone away from the robot and a hand "
          "on the stop button")
      .needs(link);
  command.add_option("--local-port", arguments->local_port, "local port of --link (default: 0, any free port)")
      .type_name("N")
      .check(whole_number(0, 65535))
      .needs(link);
  command
      .add_option("--rt", arguments->timing,
                  "run the timer of the control loop for S seconds and report how late it wakes (default: 10)")
      .type_name("S")
      .expected(0, 1)
      .default_str("10")
      .option_text("S")
      .check(positive());
  command.add_option("--rate", arguments->rate_hz, "rate of --link and --rt, in Hz (default: 1000)")
      .type_name("HZ")
      .check(positive());
  add_output_options(command, arguments->output, "mbk.robot_check/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
