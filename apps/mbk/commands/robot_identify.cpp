#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/commands/robot_commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/table_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/measure/measurement/identify_robot.h"
#include "mbk/model/robot/drive_term_names.h"
#include "mbk/present/report/robot_text.h"
#include "mbk/present/request/named_robot.h"
#include "mbk/present/request/stage_tables.h"
#include "mbk/present/result/robot_json.h"

namespace mbk::app {
namespace {

struct RobotIdentifyArguments {
  ReadRequest reading;
  measurement::RobotOptions options;
  OutputArguments output;
  std::optional<std::filesystem::path> robot;
  std::vector<std::filesystem::path> held_out;
  std::string fixed, terms, delay = "auto", stribeck_velocity;
  std::optional<double> smoothing;
};

/// A number, or the word "auto" as an absent one.
Result<std::optional<double>> number_or_auto(const std::string& given, const char* option) {
  if (given == "auto") return std::nullopt;
  double value = 0.0;
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), value);
  if (error != std::errc() || end != given.data() + given.size() || !(std::abs(value) < 1e6)) {
    return bad_usage(fmt::format("{} {} is neither a number nor 'auto'", option, quoted(given)));
  }
  return value;
}

/// Sets the terms that a list names; remaining coefficients keep their values.
Result<void> set_terms(const std::string& list, robot::RobotDescription& robot) {
  robot::DynamicModel& model = robot.model;
  robot::DriveTerms& drive = model.drive;
  const std::vector<robot::Coefficient> before = model.coefficients();
  const Vector values = model.parameters;
  for (const robot::DriveTermName& term : robot::kDriveTermNames) drive.*term.requested = false;
  for (std::size_t begin = 0; list != "none" && begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string word = list.substr(begin, end - begin);
    begin = end + 1;
    const auto term = std::ranges::find(robot::kDriveTermNames, word, &robot::DriveTermName::word);
    if (term == robot::kDriveTermNames.end()) {
      return bad_usage(fmt::format("--terms contains the unknown term {}", quoted(word)),
                       "use viscous, coulomb, stribeck, cable, offset, motor_inertia, or none");
    }
    drive.*term->requested = true;
  }
  if (drive.cable) drive.offset = true;  // k (q − q₀) has a constant
  const std::vector<robot::Coefficient> after = model.coefficients();
  model.parameters.setZero(static_cast<Index>(after.size()));
  std::vector<std::string> unstated;
  for (std::size_t k = 0; k < after.size(); ++k) {
    const auto old = std::ranges::find(before, after[k].name, &robot::Coefficient::name);
    if (old == before.end() || std::ranges::find(robot.unstated, after[k].name) != robot.unstated.end()) {
      unstated.push_back(after[k].name);
    } else {
      model.parameters[static_cast<Index>(k)] = values[old - before.begin()];
    }
  }
  robot.unstated = std::move(unstated);
  return {};
}

/// The robot's structure, with the drive terms that the options choose.
Result<void> choose(const RobotIdentifyArguments& arguments, robot::RobotDescription& robot,
                    measurement::RobotOptions& options) {
  const bool usual = !arguments.robot && arguments.terms.empty();
  if (usual || !arguments.terms.empty()) {
    MBK_TRY(set_terms(usual ? "viscous,coulomb,offset" : arguments.terms, robot));
  }
  robot::DynamicModel& model = robot.model;
  if (arguments.smoothing) model.drive.smoothing = *arguments.smoothing;
  const auto delay = MBK_TRY(number_or_auto(arguments.delay, "--motor-delay"));
  options.fit.delay = !delay;
  if (delay) model.delay = 1e-3 * *delay;
  if (!arguments.stribeck_velocity.empty()) {
    const auto velocity = MBK_TRY(number_or_auto(arguments.stribeck_velocity, "--stribeck-velocity"));
    if (velocity && !(*velocity > 0.0)) return bad_usage("--stribeck-velocity is not a positive number");
    if (!model.drive.stribeck) {
      return bad_usage("--stribeck-velocity needs a Stribeck term", "add --terms viscous,coulomb,stribeck,offset");
    }
    options.stribeck_velocity = !velocity;
    if (velocity) model.drive.stribeck_velocity = *velocity;
  }
  return {};
}

/// Which coefficients a list names.
Result<std::vector<Index>> indices_of(const std::string& list, const robot::RobotDescription& robot) {
  std::vector<Index> indices;
  if (list.empty()) return indices;
  const std::vector<robot::Coefficient> known = robot.model.coefficients();
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string name = list.substr(begin, end - begin);
    begin = end + 1;
    const auto found = std::ranges::find(known, name, &robot::Coefficient::name);
    if (found == known.end()) {
      std::vector<std::string> names;
      for (const robot::Coefficient& one : known) names.push_back(one.name);
      return bad_usage(fmt::format("--fix names the unknown coefficient {}", quoted(name)),
                       fmt::format("use one of {}", fmt::join(names, ", ")));
    }
    if (std::ranges::find(robot.unstated, name) != robot.unstated.end()) {
      return bad_usage(
          fmt::format("--fix names {}, but the description of the robot has no value for it", quoted(name)),
          "add it to the file of --robot");
    }
    indices.push_back(found - known.begin());
  }
  return indices;
}

int run(const RobotIdentifyArguments& arguments) {
  if (auto ok = check_files(arguments.reading.files, arguments.output.to); !ok) return report_error(ok.error());
  measurement::RobotOptions options = arguments.options;
  auto robot = request::describe_robot(arguments.robot);
  if (!robot) return report_error(robot.error());
  if (auto ok = choose(arguments, *robot, options); !ok) return report_error(ok.error());
  const auto fixed = indices_of(arguments.fixed, *robot);
  if (!fixed) return report_error(fixed.error());
  options.fit.fixed = *fixed;
  if (auto ok = request::check_order(options.preprocess.signals.window); !ok) return report_error(ok.error());

  ReadRequest reading = arguments.reading;
  reading.options.joints = robot->model.mechanism->joint_names();
  const auto recordings = read_recordings(reading);
  if (!recordings) return report_error(recordings.error());
  reading.files = arguments.held_out;
  const auto held_out = read_recordings(reading);
  if (!held_out) return report_error(held_out.error());
  auto found = measurement::identify_robot(*recordings, *held_out, robot->model, options);
  if (!found) return report_error(found.error());
  found->description = robot->toml;
  found->urdf = robot->urdf;
  const std::string text = arguments.output.json ? result::to_json(*found) : report::robot_text(*found);
  if (auto ok = arguments.output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return found->usable ? kFine : kNotUsable;
}

}  // namespace

namespace {

OptionTable<RobotIdentifyArguments> model_table() {
  using Arguments = RobotIdentifyArguments;
  OptionTable<Arguments> table;
  table.group("Model")
      .add({"--terms", "LIST",
            "terms of the drive model: viscous, coulomb, stribeck, cable, offset, motor_inertia, or none (default: "
            "viscous,coulomb,offset)",
            not_empty()},
           &Arguments::terms)
      .add(
          {"--fix", "LIST",
           "known coefficients, which keep the value of the robot's description: --fix link_1.mass_x,link_2.mass_x for "
           "symmetric links",
           not_empty()},
          &Arguments::fixed)
      .add(
          {"--friction-smoothing", "V",
           "velocity over which the sign of dry friction is smoothed, in rad/s or m/s; 0: not smoothed (default: 0.02)",
           not_negative()},
          &Arguments::smoothing)
      .add({"--stribeck-velocity", "V|auto", "Stribeck velocity, in rad/s or m/s; auto estimates it (default: 0.05)",
            not_empty()},
           &Arguments::stribeck_velocity)
      .add(
          {"--motor-delay", "MS|auto",
           "delay of the motors after the recorded torque, in ms; auto estimates it (default: auto). A torque held for "
           "one sample counts as half a sample",
           not_empty()},
          &Arguments::delay)
      .add(
          {"--method", "",
           "wls: least squares, each joint weighted by its noise; ls: unweighted least squares; iv: instrumental "
           "variables, "
           "which noise of the motion does not bias (default: wls)"},
          [](auto& a) -> auto& { return a.options.fit.method; })
      .add(
          {"--consistent", "",
           "require physically consistent parameters: each link with a positive mass and a possible inertia, drives "
           "that "
           "dissipate energy; parameters that the data do not determine stay near the description"},
          [](auto& a) -> auto& { return a.options.fit.consistent; })
      .add(
          {"--motion-cutoff", "HZ",
           "with iv: use the smoothed motion, low-pass filtered at this frequency in Hz, as instrument (default: the "
           "recorded reference; without one the motion in the band of the torque)",
           positive()},
          [](auto& a) -> auto& { return a.options.preprocess.motion_cutoff; })
      .add(
          {"--hac-lag", "S",
           "correlation time of the residual, in seconds, that the standard errors allow for (default: 1)", positive()},
          [](auto& a) -> auto& { return a.options.fit.hac_lag_s; });
  return table;
}

}  // namespace

Action add_robot_identify(Command group) {
  auto arguments = std::make_shared<RobotIdentifyArguments>();
  const Command command =
      group.add_command("identify", "identify the inertia and friction of a robot from its free motion");
  command.footer(
      "Examples:\n"
      "  mbk simulate free_motion --out free.h5\n"
      "  mbk robot identify free.h5\n"
      "      the robot of the thesis: alpha1 … alpha3, friction, and how well the model explains the torque\n"
      "  mbk robot identify free_1.h5 free_2.h5 --held-out free_3.h5 --json --out robot.json\n"
      "      fits several recordings and validates on another; a virtual force sensor needs robot.json\n"
      "  mbk robot identify swing_*.csv --robot examples/robots/double_pendulum.toml\n"
      "      your own robot, from its URDF\n"
      "  mbk robot identify free.h5 --terms viscous,coulomb,stribeck,offset --stribeck-velocity auto\n"
      "  mbk robot identify swing_*.csv --robot examples/robots/double_pendulum.toml --consistent\n"
      "      each link with a physically possible mass, centre of mass and inertia\n\n"
      "Record with nothing at the handle and every joint moving, fast and slow, through the positions\n"
      "where you will measure. Torque and motion are filtered alike; parameters that cannot be\n"
      "distinguished are reported.\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_reading_options(command, arguments->reading);
  const Option held_out =
      command.add_option("--held-out", arguments->held_out, "validation recordings, which do not enter the fit")
          .type_name("FILE");
  command.accept_former_name(held_out, "--held-back");
  command
      .add_option("--robot", arguments->robot,
                  "description of the robot: TOML or URDF (default: the robot of the thesis)")
      .type_name("FILE")
      .check(not_empty());
  preprocess::Options& signals = arguments->options.preprocess.signals;
  add_options(command, request::window_table(), signals.window);
  add_options(command, request::filter_table(), signals);
  add_option(command, request::resample_option(request::kFilterGroup), arguments->options.resample);
  add_options(command, model_table(), *arguments);
  add_output_options(command, arguments->output, "mbk.robot/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
