#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "apps/mbk/option_checks.h"
#include "apps/mbk/output.h"
#include "apps/mbk/robot_commands.h"
#include "apps/mbk/scenario_argument.h"
#include "mbk/experiment/session/live_check.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace mbk::app {
namespace {

struct RobotCheckArguments {
  std::string file;
  std::optional<double> live;
};

std::string findings_text(const std::vector<session::Finding>& findings) {
  using Verdict = session::Finding::Verdict;
  std::string text;
  for (const session::Finding& one : findings) {
    const char* word = one.verdict == Verdict::fine ? "fine" : one.verdict == Verdict::doubtful ? "look" : "WRONG";
    text += fmt::format("  {:<6}{}\n", word, one.text);
  }
  return text;
}

int run(const RobotCheckArguments& arguments) {
  const auto text = read_scenario_text(arguments.file);
  if (!text) return report_error(text.error());
  const auto setup = session::read_robot_setup(text->text, text->file, laboratory::read_simulation);
  if (!setup) return report_error(setup.error());
  if (arguments.live && !setup->has_device) {
    return report_error(
        {ErrorKind::usage, "it names no robot to connect to", "add [device], or omit --live", arguments.file});
  }
  const std::vector<session::Finding> findings = session::check_setup(*setup);
  bool wrong = session::worst(findings) == session::Finding::Verdict::wrong;
  if (auto ok = Output().write(session::setup_text(*setup) + findings_text(findings)); !ok) {
    return report_error(ok.error());
  }
  if (!arguments.live) return wrong ? kNotUsable : kFine;
  const auto robot = protocol::make_device(setup->trial);
  if (!robot) return report_error(robot.error());
  const auto record = session::watch_robot(**robot, setup->trial.rate, *arguments.live);
  if (!record) return report_error(record.error());
  const auto seen = session::check_live(*setup, (*robot)->facts(), *record);
  if (auto ok = Output().write(session::live_text(*setup, (*robot)->facts(), *record) + findings_text(seen)); !ok) {
    return report_error(ok.error());
  }
  wrong = wrong || session::worst(seen) == session::Finding::Verdict::wrong;
  return wrong ? kNotUsable : kFine;
}

}  // namespace

Action add_robot_check(CLI::App& group) {
  auto arguments = std::make_shared<RobotCheckArguments>();
  CLI::App* command = add_command(group, "check", "whether a robot is described, wired and reached as it should be");
  command->footer(
      "Examples:\n"
      "  mbk robot check my_experiment.toml\n"
      "      geometry, limits, wiring and device as understood, and what cannot be meant\n"
      "  mbk robot check my_experiment.toml --live 5\n"
      "      also five seconds of readings, motors off; turn the joints, press the stop button\n\n"
      "Do both before anyone sits down at a new robot. The keys of [device] stand in docs/guide/devices.md.\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 unreadable, or the robot does not answer, 4 something is wrong.");
  command->add_option("FILE", arguments->file, "a robot's description, or an experiment: .toml, or a ready one's name")
      ->required()
      ->check(suggests(ready_scenario_names()));
  command->add_option("--live", arguments->live, "connect, and watch the readings for so long with the motors off (2)")
      ->type_name("S")
      ->expected(0, 1)
      ->default_str("2")
      ->option_text("S")
      ->check(positive());
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
