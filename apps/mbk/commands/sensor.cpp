#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/options/table_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"
#include "mbk/measure/calibration/force_sensor.h"
#include "mbk/measure/measurement/find_sensor_delay.h"
#include "mbk/measure/preprocess/resample.h"
#include "mbk/present/report/sensor_text.h"
#include "mbk/present/request/stage_tables.h"
#include "mbk/present/result/sensor_json.h"

namespace mbk::app {
namespace {

struct SensorCalibrateArguments {
  ReadRequest reading;
  OutputArguments output;
  calibration::SensorCalibrationOptions options;
  calibration::Converter converter{0, 0.0};  ///< bits 0: its step is looked for
  calibration::SensorFrame frame = calibration::SensorFrame::automatic;
};

Result<SensorCalibration> calibrate(const SensorCalibrateArguments& arguments) {
  calibration::SensorCalibrationOptions options = arguments.options;
  if (arguments.reading.options.axes > 2) {
    return bad_usage("only sensors with one or two axes can be calibrated", "pass --axes 1, or omit it");
  }
  options.crosstalk = arguments.reading.options.axes != 1;
  if (arguments.converter.bits > 0) options.converter = arguments.converter;
  ReadRequest reading = arguments.reading;
  reading.options.axes = 2;  // --axes counts those of the sensor here; the names are Fx, Fy, Vx, Vy either way
  reading.options.untimed = true;
  const auto recordings = MBK_TRY(read_recordings(reading));
  std::vector<calibration::SensorRun> runs;
  for (const Recording& recording : recordings) {
    auto run = MBK_TRY(calibration::sensor_run(recording, arguments.frame));
    runs.push_back(std::move(run));
  }
  return calibration::calibrate_sensor(runs, options);
}

int run_calibrate(const SensorCalibrateArguments& arguments) {
  const Output& output = arguments.output.to;
  if (auto ok = output.check(arguments.reading.files); !ok) return report_error(ok.error());
  const auto calibration = calibrate(arguments);
  if (!calibration) return report_error(calibration.error());
  const std::string text = arguments.output.json ? result::to_json(*calibration) : report::sensor_text(*calibration);
  if (auto ok = output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return kFine;
}

OptionTable<SensorCalibrateArguments> calibrate_table() {
  OptionTable<SensorCalibrateArguments> table;
  table
      .add(
          {"--lever-arm-mm", "MM", "lever arm from the strain gauges to the load, in mm; stored for --sensor",
           positive()},
          [](auto& a) -> auto& { return a.options.lever_arm; }, kMillimetres)
      .add(
          {"--bits", "N", "resolution of the converter, in bits (default: its step is estimated from the data)",
           whole_number(2, 32)},
          [](auto& a) -> auto& { return a.converter.bits; })
      .add(
          {"--range", "V", "range of the converter, from -V to +V, in volts", positive(), "--bits"},
          [](auto& a) -> auto& { return a.converter.range; })
      .add({"--sensor-frame", "",
            "link: the reference force is rotated into the axes of the last link, at angle q2; base: it is not; auto: "
            "link if q2 was recorded (default: auto)"},
           &SensorCalibrateArguments::frame)
      .add(
          {"--longest-delay-ms", "MS",
           "maximum lag between voltage and reference, either way, in ms (default: 50; 0: none)", not_negative()},
          [](auto& a) -> auto& { return a.options.longest_delay; }, kMilliseconds)
      .add(
          {"--hac-lag", "S",
           "correlation time of the residual, in seconds, that the standard errors allow for (default: 1)",
           not_negative()},
          [](auto& a) -> auto& { return a.options.hac_lag_s; });
  return table;
}

Action add_sensor_calibrate(Command sensor) {
  auto arguments = std::make_shared<SensorCalibrateArguments>();
  const Command command =
      sensor.add_command("calibrate", "calibrate slope, zero, crosstalk and noise of a sensor with known loads");
  command.footer(
      "Examples:\n"
      "  mbk sensor calibrate loads.csv --lever-arm-mm 68.8 --bits 12 --range 10\n"
      "      columns Fx, Fy in N and Vx, Vy in V, one row for each load; repeat loads and use both signs\n"
      "  mbk sensor calibrate --channels Fx=mass*9.81,Vx=volt x_loads.csv --axes 1\n"
      "      one axis, loaded with hanging masses in kg\n"
      "  mbk sensor calibrate trial.csv --json --out cell.json\n"
      "      Fx, Fy of a reference sensor over time beside Vx, Vy; used by 'mbk measure --sensor cell.json'\n\n"
      "Each FILE is a run with its own zero; the slopes come from all runs, the stored zero from the last.");
  ReadRequest& reading = arguments->reading;
  add_reading_options(command, reading);
  command.get_option("--axes").description("1: calibrate each axis separately (default: crosstalk is fitted too)");
  command.get_option("FILE").description("tables of loads, or recordings: .csv, .h5 or .mat");
  add_options(command, calibrate_table(), *arguments);
  command.get_option("--bits").needs(command.get_option("--range"));
  command.add_flag("--json", arguments->output.json, "print JSON, as --sensor reads it: schema mbk.sensor/1");
  arguments->output.to.add_options(command);
  return [arguments] { return run_calibrate(*arguments); };
}

struct SensorDelayArguments {
  ReadRequest reading;
  preprocess::Options signals;
  std::optional<Hertz> resample;
  OutputArguments output;
  double mass = 0.0;
};

Result<MeasuredDelay> find_delay(const SensorDelayArguments& arguments) {
  auto recordings = MBK_TRY(read_recordings(arguments.reading));
  if (recordings.size() != 1)
    return bad_usage("several recordings are named, but a delay is found in one", "name one FILE");
  preprocess::Options signals = arguments.signals;
  MBK_TRY(request::check_order(signals.window));
  signals.axes = arguments.reading.options.axes;
  if (arguments.resample) {
    recordings.front() = MBK_TRY(preprocess::resample(recordings.front(), *arguments.resample));
  }
  auto found = measurement::find_sensor_delay(recordings.front(), arguments.mass, signals);
  if (!found) return tl::unexpected<Error>(found.error().in(recordings.front().sources.front().label()));
  return found;
}

int run_delay(const SensorDelayArguments& arguments) {
  const Output& output = arguments.output.to;
  if (auto ok = output.check(arguments.reading.files); !ok) return report_error(ok.error());
  const auto found = find_delay(arguments);
  if (!found) return report_error(found.error());
  const std::string text = arguments.output.json ? result::to_json(*found) : report::sensor_delay_text(*found);
  if (auto ok = output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return found->usable() ? kFine : kNotUsable;
}

Action add_delay(Command sensor) {
  auto arguments = std::make_shared<SensorDelayArguments>();
  const Command command = sensor.add_command("delay", "measure the delay of the force signal with a known mass");
  command.footer(
      "Fix a known mass to the handle, let the robot move it for half a minute (a multisine up to a few\n"
      "hertz), and record as in a trial. Nobody may touch the handle.\n\n"
      "Examples:\n"
      "  mbk sensor delay mass.h5 --mass 1.194\n"
      "      1 kg, plus 0.194 kg of the handle beyond the force sensor\n"
      "  mbk measure trial.h5 --force-delay-ms 10.2\n"
      "      measures a trial with this delay corrected\n\n"
      "Exit codes: 0 the delay was found, 2 wrong usage, 3 bad or unreadable data, 4 the delay is not\n"
      "usable: something other than this mass is at the handle, or its motion is too slow or too short.");
  add_reading_options(command, arguments->reading);
  command.add_option("--mass", arguments->mass, "mass beyond the force sensor, including that of the handle, in kg")
      .type_name("KG")
      .check(positive())
      .required();
  add_options(command, request::window_table(), arguments->signals.window);
  add_options(command, request::filter_table(), arguments->signals);
  add_option(command, request::resample_option(request::kFilterGroup), arguments->resample);
  command.add_flag("--json", arguments->output.json, "print JSON: schema mbk.sensor_delay/1");
  arguments->output.to.add_options(command);
  return [arguments] { return run_delay(*arguments); };
}

}  // namespace

Action add_sensor(Command app) {
  const Command command = app.add_command("sensor", "calibrate your own force sensor: slope, zero and delay");
  command.require_subcommand();
  command.footer(
      "Examples:\n"
      "  mbk sensor calibrate loads.csv --lever-arm-mm 68.8 --json --out cell.json\n"
      "  mbk measure --sensor cell.json trial.csv\n"
      "  mbk sensor delay mass.h5 --mass 1.194");
  const Actions actions = {{"calibrate", add_sensor_calibrate(command)}, {"delay", add_delay(command)}};
  return [command, actions] { return run_chosen(command, actions); };
}

}  // namespace mbk::app
