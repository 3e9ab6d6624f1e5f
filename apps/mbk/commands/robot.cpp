#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/robot_commands.h"
#include "apps/mbk/options/output.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

struct RobotArguments {
  std::optional<std::string> at;
  std::optional<double> d1_mm, d2_mm;
  bool json = false;
  Output output;
};

/// "X,Y" in millimetres as metres.
Result<Eigen::Vector2d> place(const std::string& given) {
  const auto wrong = [&] {
    return bad_usage(fmt::format("--at {} is not two numbers", quoted(given)), "write x and y in mm: --at 300,50");
  };
  const std::size_t comma = given.find(',');
  if (comma == std::string::npos) return wrong();
  Eigen::Vector2d metres;
  for (int k = 0; k < 2; ++k) {
    const std::string part = k == 0 ? given.substr(0, comma) : given.substr(comma + 1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    constexpr double kFarthest = 1e6;  // [mm]: also not for nan and inf
    if (error != std::errc() || end != part.data() + part.size() || !(std::abs(value) <= kFarthest)) return wrong();
    metres[k] = 1e-3 * value;
  }
  return metres;
}

int run_workspace(const RobotArguments& arguments) {
  if (auto ok = arguments.output.check({}); !ok) return report_error(ok.error());
  const bool drawing = arguments.output.file && arguments.output.file->extension() == ".svg";
  if (drawing && arguments.json) {
    return report_error(
        {ErrorKind::usage, "--json cannot be written to an .svg file", "name a .json file, or omit --json", ""});
  }
  robot::PlanarRobot robot;
  if (arguments.d1_mm) robot.geometry.d1 = 1e-3 * *arguments.d1_mm;
  if (arguments.d2_mm) robot.geometry.d2 = 1e-3 * *arguments.d2_mm;
  const auto workspace = robot::workspace(robot.geometry);
  if (!workspace) return report_error(workspace.error());
  std::optional<robot::Posture> posture;
  if (arguments.at) {
    const auto hand = place(*arguments.at);
    if (!hand) return report_error(hand.error());
    const auto found = robot::posture(robot, *hand);
    if (!found) return report_error(found.error());
    posture = *found;
  }
  std::string text;
  if (drawing) {
    text = report::chart_svg(report::workspace_chart(*workspace, posture));
  } else {
    text = arguments.json ? result::to_json(*workspace, posture) : report::workspace_text(*workspace, posture);
  }
  if (auto ok = arguments.output.write(text, {}); !ok) return report_error(ok.error());
  return kFine;
}

Action add_workspace(Command group) {
  auto arguments = std::make_shared<RobotArguments>();
  const Command command =
      group.add_command("workspace", "show the workspace of the hand, and the robot's state at one position");
  command.footer(
      "Examples:\n"
      "  mbk robot workspace\n"
      "  mbk robot workspace --at 300,50\n"
      "  mbk robot workspace --at 300,50 --out workspace.svg\n\n"
      "x and y are in the robot's base frame; θ₁ is the angle of the first link from x, θ₂ that of the\n"
      "last from −y. A position that the robot cannot reach is rejected with the limit that excludes it\n"
      "(exit code 2).");
  command
      .add_option("--at", arguments->at,
                  "also report joint angles, Jacobian, inertia and margins with the hand at this position, in mm")
      .type_name("X,Y[mm]");
  command.add_option("--d1-mm", arguments->d1_mm, "length of the first link, in mm (default: 254)")
      .type_name("MM")
      .check(positive());
  command.add_option("--d2-mm", arguments->d2_mm, "length of the last link, in mm (default: 266.7)")
      .type_name("MM")
      .check(positive());
  command.add_flag("--json", arguments->json, "print JSON: schema mbk.workspace/1");
  arguments->output.add_options(command);
  command.get_option("--out").description(
      "write to this file instead of standard output; an .svg file gets the drawing");
  return [arguments] { return run_workspace(*arguments); };
}

}  // namespace

Action add_robot(Command app) {
  const Command group =
      app.add_command("robot", "describe, check and identify a robot; estimate the hand force without a sensor");
  group.footer(
      "Examples:\n"
      "  mbk robot workspace --at 300,50\n"
      "  mbk robot describe my_robot.toml\n"
      "  mbk robot check my_experiment.toml --live\n"
      "  mbk robot identify free_motion.h5\n");
  group.require_subcommand();
  const Actions actions = {{"workspace", add_workspace(group)},
                           {"describe", add_robot_describe(group)},
                           {"identify", add_robot_identify(group)},
                           {"force", add_robot_force(group)},
                           {"check", add_robot_check(group)}};
  return [group, actions] { return run_chosen(group, actions); };
}

}  // namespace mbk::app
