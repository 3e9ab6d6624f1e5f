#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/mbk/commands/new_commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/report_file.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/questions.h"
#include "mbk/files/contents/read_text.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/model/robot_file/robot_file.h"

namespace mbk::app {
namespace {

struct NewRobotArguments : NewFileArguments {
  NewRobotArguments() { out = "robot.toml"; }
  std::filesystem::path urdf;
};

constexpr const char* kHead =
    "# A robot for mbk. docs/guide/own_robot.md has every key.\n"
    "#   mbk robot describe FILE    what mbk understands of it\n";

/// The section of a kind, question by question.
struct Asked {
  const char *question, *key, *by_default;
  std::size_t numbers;  ///< with commas between them
};

Result<std::string> answered(const Questions& questions, std::initializer_list<Asked> all) {
  std::string text;
  for (const Asked& one : all) {
    const auto answer = MBK_TRY(questions.ask(one.question, one.by_default,
                                              one.numbers > 1 ? numbers_with_commas(one.numbers) : positive_number()));
    text += one.numbers > 1 ? fmt::format("{} = [{}]\n", one.key, answer) : fmt::format("{} = {}\n", one.key, answer);
  }
  return text;
}

Result<std::string> planar(const Questions& questions) {
  const auto keys = MBK_TRY(answered(
      questions, {{"Length of the first link, mm", "d1_mm", "254", 1},
                  {"Length of the second link to the handle, mm", "d2_mm", "266.7", 1},
                  {"Range of the first joint, low,high, deg", "theta1_deg", "-55,90", 2},
                  {"Range of the second link's angle against the base, low,high, deg", "theta2_deg", "0,145", 2},
                  {"Inertia parameters alpha1,alpha2,alpha3, kg m² ('mbk robot identify' finds them)", "alpha_kg_m2",
                   "0.06929,0.04217,0.04416", 3}}));
  return std::string(kHead) + "[robot]\nkind = \"planar\"\n" + keys;
}

Result<std::string> one_axis(const Questions& questions) {
  const auto slides = MBK_TRY(questions.ask("Does it slide or turn", "turn", word_of_these({"slide", "turn"})));
  const bool sliding = slides == "slide";
  const auto keys = MBK_TRY(sliding ? answered(questions, {{"Limits low,high, mm", "limits_mm", "-350,350", 2},
                                                           {"Moving mass, kg", "mass_kg", "", 1}})
                                    : answered(questions, {{"Limits low,high, deg", "limits_deg", "-60,60", 2},
                                                           {"Moment of inertia, kg m²", "inertia_kg_m2", "", 1}}));
  return std::string(kHead) + fmt::format("[robot]\nkind = \"one_axis\"\nslides = {}\n", sliding) + keys;
}

/// From a URDF: what the file says stays there.
Result<std::string> from_urdf(const Questions& questions, const NewRobotArguments& arguments) {
  std::error_code ignored;
  MBK_TRY(robot_file::read_robot_description(arguments.urdf));
  const auto axes = MBK_TRY(questions.ask("Plane in which the hand is measured, two of x,y,z of the base frame", "x,y",
                                          word_of_these({"x,y", "x,z", "y,z", "y,x", "z,x", "z,y"})));
  const auto gravity =
      MBK_TRY(questions.ask("Gravity along x,y,z of the base frame, m/s²", "0,0,-9.81", numbers_with_commas(3)));
  const auto folder = std::filesystem::absolute(arguments.out, ignored).parent_path();
  const auto file = std::filesystem::absolute(arguments.urdf, ignored).lexically_proximate(folder);
  return std::string(kHead) + fmt::format(
                                  "[robot]\nkind = \"urdf\"\nfile = \"{}\"             # from the folder of this file\n"
                                  "gravity_m_per_s2 = [{}]\nhand_axes = [\"{}\", \"{}\"]\n",
                                  file.generic_string(), gravity, axes.substr(0, 1), axes.substr(2, 1));
}

Result<std::string> robot_text(const Questions& questions, const NewRobotArguments& arguments) {
  if (!arguments.urdf.empty()) return from_urdf(questions, arguments);
  const auto kind =
      MBK_TRY(questions.ask("Robot: planar (two links) or one_axis", "planar", word_of_these({"planar", "one_axis"})));
  return kind == "planar" ? planar(questions) : one_axis(questions);
}

int run(const NewRobotArguments& arguments) {
  if (auto ok = check_new_file(arguments.out, "--out", arguments.overwrite, {arguments.urdf}); !ok) {
    return report_error(ok.error());
  }
  const auto text = robot_text(Questions(arguments.yes), arguments);
  if (!text) return report_error(text.error());
  const auto urdf = arguments.urdf.empty() ? Result<std::string>("") : read_text(arguments.urdf);
  if (!urdf) return report_error(urdf.error());
  const auto robot = robot_file::parse_robot_description(*text, *urdf, arguments.out.string());
  if (!robot) return report_error(robot.error());
  if (auto ok = recording::write_file(arguments.out, arguments.overwrite, *text); !ok) return report_error(ok.error());
  say("{}; next: mbk robot describe {}\n", arguments.out.string(), shell_word(arguments.out.string()));
  return kFine;
}

}  // namespace

Action add_new_robot(Command group) {
  auto arguments = std::make_shared<NewRobotArguments>();
  const Command command = group.add_command("robot", "the description of a robot, from a few answers or a URDF");
  command.footer(
      "Examples:\n"
      "  mbk new robot --out robot.toml\n"
      "      two links in a plane, or one axis: asks for lengths, ranges and inertia\n"
      "  mbk new robot arm.urdf --out arm.toml\n"
      "      looks at the URDF, and asks for the plane of the hand and for gravity\n"
      "  mbk new robot --yes && mbk robot describe robot.toml\n\n"
      "The file is written only after it was read as 'mbk robot describe' reads it.");
  command.add_option("ARM.urdf", arguments->urdf, "a robot's URDF, where there is one");
  add_new_file_options(command, *arguments);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
