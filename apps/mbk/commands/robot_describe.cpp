#include <memory>
#include <string>

#include "apps/mbk/commands/robot_commands.h"
#include "apps/mbk/options/output.h"
#include "mbk/measure/identify/base_parameters.h"
#include "mbk/model/robot_file/robot_file.h"
#include "mbk/present/report/robot_description_text.h"
#include "mbk/present/result/robot_json.h"

namespace mbk::app {
namespace {

struct RobotDescribeArguments {
  std::filesystem::path file;
  bool json = false;
  Output output;
};

int run(const RobotDescribeArguments& arguments) {
  if (auto ok = arguments.output.check({arguments.file}); !ok) return report_error(ok.error());
  const auto description = robot_file::read_robot_description(arguments.file);
  if (!description) return report_error(description.error());
  const auto base = identify::structural_columns(description->model);
  const std::string text =
      arguments.json ? result::to_json(*description, base) : report::robot_description_text(*description, base);
  if (auto ok = arguments.output.write(text, {arguments.file}); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_robot_describe(Command group) {
  auto arguments = std::make_shared<RobotDescribeArguments>();
  const Command command = group.add_command("describe", "what mbk understands of a robot's description or URDF");
  command.footer(
      "Examples:\n"
      "  mbk robot describe my_robot.toml\n"
      "  mbk robot describe arm.urdf\n"
      "      the whole chain, from the root of the URDF to its only leaf\n\n"
      "Look at the limits, and at where the hand is with every joint at zero, before you record.\n"
      "docs/guide/own_robot.md lists the keys of a description.");
  command.add_option("FILE", arguments->file, "description of a robot: .toml, or a .urdf alone").required();
  command.add_flag("--json", arguments->json, "for machines: schema mbk.robot_description/1");
  arguments->output.add_options(command);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
