#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/output_options.h"
#include "apps/mbk/reading_options.h"
#include "apps/mbk/sensor_options.h"
#include "mbk/measure/calibration/force_sensor.h"
#include "mbk/present/report/sensor_text.h"
#include "mbk/present/result/sensor_json.h"

namespace mbk::app {
namespace {

constexpr double kMilliseconds = 1000.0;

struct SensorCalibrateArguments {
  ReadingArguments reading;
  OutputArguments output;
  std::optional<double> lever_arm_mm, range;
  std::optional<int> bits;
  calibration::SensorFrame frame = calibration::SensorFrame::automatic;
  double hac_lag_s = 1.0;
  double longest_delay_ms = 50.0;
};

Result<calibration::SensorCalibrationOptions> options_of(const SensorCalibrateArguments& arguments) {
  calibration::SensorCalibrationOptions options;
  options.crosstalk = arguments.reading.axes != 1;
  if (arguments.lever_arm_mm) options.lever_arm = *arguments.lever_arm_mm / kMillimetres;
  if (arguments.bits) options.converter = calibration::Converter{*arguments.bits, *arguments.range};
  options.hac_lag_s = arguments.hac_lag_s;
  options.longest_delay = arguments.longest_delay_ms / kMilliseconds;
  return options;
}

Result<SensorCalibration> calibrate(const SensorCalibrateArguments& arguments) {
  const auto options = options_of(arguments);
  if (!options) return tl::unexpected(options.error());
  ReadingArguments reading = arguments.reading;
  reading.axes = 2;  // --axes counts those of the sensor here; the names are Fx, Fy, Vx, Vy either way
  reading.untimed = true;
  const auto recordings = read_recordings(reading);
  if (!recordings) return tl::unexpected(recordings.error());
  std::vector<calibration::SensorRun> runs;
  for (const Recording& recording : *recordings) {
    auto run = calibration::sensor_run(recording, arguments.frame);
    if (!run) return tl::unexpected(run.error());
    runs.push_back(std::move(*run));
  }
  return calibration::calibrate_sensor(runs, *options);
}

int run_calibrate(const SensorCalibrateArguments& arguments) {
  const Output& output = arguments.output.to;
  if (auto ok = output.check(arguments.reading.files); !ok) return report_error(ok.error());
  const auto calibration = calibrate(arguments);
  if (!calibration) return report_error(calibration.error());
  const std::string text = arguments.output.json ? result::to_json(*calibration) : report::sensor_text(*calibration);
  if (auto ok = output.write(text); !ok) return report_error(ok.error());
  return kFine;
}

Action add_calibrate(CLI::App& sensor) {
  auto arguments = std::make_shared<SensorCalibrateArguments>();
  CLI::App* command = add_command(sensor, "calibrate", "slope, zero, crosstalk and noise from known loads");
  command->footer(
      "Examples:\n"
      "  mbk sensor calibrate loads.csv --lever-arm-mm 68.8 --bits 12 --range 10\n"
      "      columns Fx, Fy in N and Vx, Vy in V, one row a load; repeats and both signs are welcome\n"
      "  mbk sensor calibrate --channels Fx=mass*9.81,Vx=volt x_loads.csv --axes 1\n"
      "      a hung mass in kg, one axis\n"
      "  mbk sensor calibrate trial.csv --json --out cell.json\n"
      "      a reference sensor's Fx, Fy over time beside Vx, Vy; 'mbk measure --sensor cell.json' uses it\n\n"
      "Each FILE is a run with a zero of its own; the slopes come from all runs, the zero from the last.");
  ReadingArguments& reading = arguments->reading;
  add_reading_options(*command, reading);
  command->get_option("--axes")->description("1: each axis separately; otherwise crosstalk is fitted too");
  command->get_option("FILE")->description("tables of loads or recordings: .csv, .h5 or .mat");
  command->add_option("--lever-arm-mm", arguments->lever_arm_mm, "from the gauges to the load, kept for --sensor")
      ->type_name("MM")
      ->check(positive());
  CLI::Option* const bits =
      command->add_option("--bits", arguments->bits, "of the converter; otherwise its step is looked for in the data")
          ->type_name("N")
          ->check(whole_number(2, 32));
  CLI::Option* const range = command->add_option("--range", arguments->range, "of the converter, ± volts")
                                 ->type_name("V")
                                 ->check(positive())
                                 ->needs(bits);
  bits->needs(range);
  add_sensor_frame(
      *command, arguments->frame,
      "link: the reference's force is turned into the axes of the last link, at q2; base: it is not; auto: "
      "link where q2 is there");
  command
      ->add_option("--longest-delay-ms", arguments->longest_delay_ms,
                   "by which the voltage may come after a reference, either way (50; 0: none)")
      ->type_name("MS")
      ->check(not_negative());
  command
      ->add_option("--hac-lag", arguments->hac_lag_s,
                   "reach of the residual's correlation in the standard errors, s (1)")
      ->type_name("S")
      ->check(not_negative());
  command->add_flag("--json", arguments->output.json, "for machines: schema mbk.sensor/1, which --sensor reads");
  arguments->output.to.add_options(*command);
  return [arguments] { return run_calibrate(*arguments); };
}

}  // namespace

Action add_sensor(CLI::App& app) {
  CLI::App* command = add_command(app, "sensor", "calibrate a force sensor of your own");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  mbk sensor calibrate loads.csv --lever-arm-mm 68.8 --json --out cell.json\n"
      "  mbk measure --sensor cell.json trial.csv");
  return add_calibrate(*command);
}

}  // namespace mbk::app
