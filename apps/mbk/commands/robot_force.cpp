#include <memory>
#include <string>

#include "apps/mbk/commands/robot_commands.h"
#include "apps/mbk/options/measure_options.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/table_options.h"
#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/recording/write.h"
#include "mbk/measure/measurement/compute_force.h"
#include "mbk/present/report/robot_text.h"
#include "mbk/present/request/named_robot.h"
#include "mbk/present/request/stage_tables.h"
#include "mbk/present/result/robot_json.h"

namespace mbk::app {
namespace {

struct RobotForceArguments {
  ReadRequest reading;
  measurement::Options options;
  OutputArguments output;
  std::optional<std::filesystem::path> robot;
};

int run(const RobotForceArguments& arguments) {
  std::optional<recording::Format> format;
  if (arguments.output.to.file) {
    const auto found = recording::format_of(*arguments.output.to.file);
    if (!found) return report_error(found.error());
    format = *found;
  }
  if (auto ok = check_files(arguments.reading.files, arguments.output.to); !ok) return report_error(ok.error());
  if (arguments.reading.files.size() > 1 && !arguments.reading.parts) {
    return report_error({ErrorKind::usage, "several recordings are named, but only one can be processed",
                         "name one FILE, or join numbered parts with --parts", ""});
  }
  measurement::Options options = arguments.options;
  preprocess::Options& p = options.preprocess;
  if (auto ok = request::check_order(p.window); !ok) return report_error(ok.error());
  auto robot = request::robot_of(arguments.robot);
  if (!robot) return report_error(robot.error());
  p.robot = std::make_shared<const robot::DynamicModel>(std::move(*robot));
  const auto recordings = read_recordings(reading_for(arguments.reading, options));
  if (!recordings) return report_error(recordings.error());
  const auto made = measurement::compute_force(recordings->front(), options);
  if (!made) return report_error(made.error().in(arguments.reading.files.front().string()));
  if (format) {
    if (auto ok = recording::write(made->recording, *arguments.output.to.file, *format, arguments.output.to.overwrite);
        !ok) {
      return report_error(ok.error());
    }
  }
  const std::string text = arguments.output.json ? result::to_json(made->summary) : report::force_text(made->summary);
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_robot_force(Command group) {
  auto arguments = std::make_shared<RobotForceArguments>();
  const Command command = group.add_command("force", "estimate the force at the hand without a force sensor");
  command.footer(
      "Examples:\n"
      "  mbk robot force log.h5 --robot robot.json\n"
      "      its size and uncertainty, compared with the force sensor if there is one\n"
      "  mbk robot force log.h5 --robot robot.json --out with_force.h5\n"
      "      writes a recording with the computed force_x and force_y; those of a sensor become sensor_force_x …\n\n"
      "'mbk measure --force-source virtual' uses the same estimate.\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_reading_options(command, arguments->reading);
  command
      .add_option("--robot", arguments->robot,
                  "the robot's dynamics, as written by 'mbk robot identify --json' (default: the robot of the thesis)")
      .type_name("FILE")
      .check(not_empty());
  arguments->options.preprocess.force_source = ForceSource::virtual_sensor;
  add_choice(
      command, "--force-source", arguments->options.preprocess.force_source,
      {ForceSource::virtual_sensor, ForceSource::observer},
      "virtual: from the whole motion, not causal; observer: causal, as while the robot runs (default: virtual)");
  add_choice(command, "--acceleration", arguments->options.preprocess.acceleration,
             "source of the acceleration (default: derivative)");
  add_options(command, request::window_table(), arguments->options.preprocess.window);
  add_options(command, request::filter_table(), arguments->options.preprocess);
  add_option(command, request::resample_option(request::kFilterGroup), arguments->options.resample);
  command.remove_option("--split");  // nothing is held out here
  command.remove_option("--every");
  add_output_options(command, arguments->output, "mbk.force/1");
  command.get_option("--out").description("write a recording with the force to this file: .h5, .mat or .csv");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
