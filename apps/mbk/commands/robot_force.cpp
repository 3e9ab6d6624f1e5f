#include <memory>
#include <string>

#include "apps/mbk/options/measure_options.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/preprocess_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/commands/robot_commands.h"
#include "apps/mbk/options/robot_file.h"
#include "apps/mbk/options/word_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/recording/write.h"
#include "mbk/measure/measurement/compute_force.h"
#include "mbk/present/report/robot_text.h"
#include "mbk/present/result/robot_json.h"

namespace mbk::app {
namespace {

struct RobotForceArguments {
  ReadingArguments reading;
  WindowArguments window;
  FilterArguments filters;
  OutputArguments output;
  std::optional<std::filesystem::path> robot;
  ForceSource source = ForceSource::virtual_sensor;
  AccelerationSource acceleration = AccelerationSource::derivative;
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
    return report_error({ErrorKind::usage, "one recording at a time", "or join numbered parts with --parts", ""});
  }
  const auto signals = signal_options(arguments.window, arguments.filters);
  if (!signals) return report_error(signals.error());
  measurement::Options options;
  options.preprocess = *signals;
  auto robot = robot_of(arguments.robot);
  if (!robot) return report_error(robot.error());
  preprocess::Options& p = options.preprocess;
  p.robot = std::make_shared<const robot::DynamicModel>(std::move(*robot));
  p.force_source = arguments.source;
  if (arguments.acceleration == AccelerationSource::sensor) p.acceleration = AccelerationSource::sensor;
  if (arguments.filters.resample_hz) options.resample = Hertz(*arguments.filters.resample_hz);
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
  const Command command = group.add_command("force", "the force at the hand without a force sensor");
  command.footer(
      "Examples:\n"
      "  mbk robot force log.h5 --robot robot.json\n"
      "      how large it is, how sure, and beside the force sensor where there is one\n"
      "  mbk robot force log.h5 --robot robot.json --out with_force.h5\n"
      "      a recording with force_x and force_y computed; those of a sensor become sensor_force_x …\n\n"
      "'mbk measure --force-source virtual' does the same on its way.\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_reading_options(command, arguments->reading);
  command
      .add_option("--robot", arguments->robot,
                  "the robot's dynamics, from 'mbk robot identify --json'; without it those of the thesis's robot")
      .type_name("FILE")
      .check(not_empty());
  add_choice(command, "--force-source", arguments->source, {ForceSource::virtual_sensor, ForceSource::observer},
             "virtual: from the whole motion, not causal; observer: as it could be had while the robot runs "
             "(virtual)");
  add_choice(command, "--acceleration", arguments->acceleration, "where the acceleration comes from (derivative)");
  add_window_options(command, arguments->window);
  add_filter_options(command, arguments->filters);
  command.remove_option("--split");  // nothing is held out here
  command.remove_option("--every");
  add_output_options(command, arguments->output, "mbk.force/1");
  command.get_option("--out").description("write a recording with the force to this file: .h5, .mat or .csv");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
