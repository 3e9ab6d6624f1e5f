#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/table_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/measure/measurement/measure_movement.h"
#include "mbk/present/report/movement_text.h"
#include "mbk/present/request/stage_tables.h"
#include "mbk/present/result/movement_json.h"

namespace mbk::app {
namespace movement_command {

struct MovementArguments {
  ReadRequest reading;
  SensorRequest sensor;
  measurement::MovementQualityOptions options;
  OutputArguments output;
};

OptionTable<measurement::MovementQualityOptions> options_table() {
  OptionTable<measurement::MovementQualityOptions> table;
  table.group(request::kWindowGroup)
      .add(
          {"--from", "S", "start of the analysed interval, in seconds from the start of the recording", not_negative()},
          [](auto& options) -> auto& { return options.window.from_s; })
      .add(
          {"--to", "S", "end of the analysed interval, in seconds from the start of the recording", positive()},
          [](auto& options) -> auto& { return options.window.to_s; })
      .group("")
      .add(request::resample_option(), &measurement::MovementQualityOptions::resample)
      .add(
          {"--cutoff", "HZ", "cutoff frequency of the Savitzky–Golay filter of the speed, in Hz (default: 20)",
           positive()},
          [](auto& options) -> auto& { return options.movement.cutoff_hz; });
  return table;
}

int run_movement(const MovementArguments& arguments) {
  if (auto ok = check_files(arguments.reading.files, arguments.output.to); !ok) return report_error(ok.error());
  measurement::MovementQualityOptions options = arguments.options;
  options.axes = arguments.reading.options.axes;
  if (auto ok = request::check_order(options.window); !ok) return report_error(ok.error());
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
      app.add_command("movement", "assess reaching movements: smoothness, path, speed, endpoint, work and force");
  command.footer(
      "Examples:\n"
      "  mbk movement reaches.csv\n"
      "      SPARC, LDLJ, speed peaks and path ratio of each reach from rest to rest\n"
      "  mbk movement before.csv after.csv --json\n\n"
      "Exit codes: " +
      std::string(kExitCodes));
  add_reading_options(command, arguments->reading);
  add_sensor_options(command, arguments->sensor);
  add_options(command, options_table(), arguments->options);
  add_output_options(command, arguments->output, "mbk.movement/1");
  return [arguments] { return run_movement(*arguments); };
}

}  // namespace mbk::app
