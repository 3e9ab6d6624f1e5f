#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/preprocess_options.h"
#include "apps/mbk/options/reading_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/measure/measurement/measure_movement.h"
#include "mbk/present/report/movement_text.h"
#include "mbk/present/result/movement_json.h"

namespace mbk::app {
namespace movement_command {

struct MovementArguments {
  ReadingArguments reading;
  SensorArguments sensor;
  std::optional<double> from_s, to_s, resample_hz;
  double cutoff_hz = analyse::MovementOptions().cutoff_hz;
  OutputArguments output;
};

int run_movement(const MovementArguments& arguments) {
  if (auto ok = check_files(arguments.reading.files, arguments.output.to); !ok) return report_error(ok.error());
  measurement::MovementQualityOptions options;
  options.axes = arguments.reading.axes;
  const auto window = window_limits({arguments.from_s, std::nullopt, arguments.to_s});
  if (!window) return report_error(window.error());
  options.window = *window;
  if (arguments.resample_hz) options.resample = Hertz(*arguments.resample_hz);
  options.movement.cutoff_hz = arguments.cutoff_hz;
  const auto recordings = read_perturbations(arguments.reading, arguments.sensor);
  if (!recordings) return report_error(recordings.error());
  std::vector<MovementQuality> all;
  for (const Recording& recording : *recordings) {
    say_exclusions(recording, false);
    auto found = measurement::movement_quality(recording, options);
    if (!found) {
      return report_error(recording.sources.empty() ? found.error()
                                                    : found.error().in(recording.sources.front().label()));
    }
    all.push_back(std::move(*found));
  }
  std::string text;
  if (arguments.output.json) {
    text = result::to_json(all);
  } else {
    for (const MovementQuality& one : all) text += (text.empty() ? "" : "\n") + report::movement_text(one);
  }
  if (auto ok = arguments.output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace movement_command

Action add_movement(Command app) {
  using namespace movement_command;
  auto arguments = std::make_shared<MovementArguments>();
  const Command command =
      app.add_command("movement", "quality of reaches: smoothness, path, speed, endpoint, work, force");
  command.footer(
      "Examples:\n"
      "  mbk movement reaches.csv\n"
      "      each reach from rest to rest: SPARC, LDLJ, peaks of speed, path ratio\n"
      "  mbk movement before.csv after.csv --json\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_reading_options(command, arguments->reading);
  add_sensor_options(command, arguments->sensor);
  const char* const interval = "Analysed interval";
  command.add_option("--from", arguments->from_s, "first second of the recording that counts")
      .type_name("S")
      .check(not_negative())
      .group(interval);
  command.add_option("--to", arguments->to_s, "last second that counts")
      .type_name("S")
      .check(positive())
      .group(interval);
  command
      .add_option("--resample", arguments->resample_hz,
                  "put an uneven clock right first, by straight lines; never done unasked")
      .type_name("HZ")
      .check(positive());
  command.add_option("--cutoff", arguments->cutoff_hz, "of the Savitzky–Golay filter behind the speed, Hz (20)")
      .type_name("HZ")
      .check(positive());
  add_output_options(command, arguments->output, "mbk.movement/1");
  return [arguments] { return run_movement(*arguments); };
}

}  // namespace mbk::app
