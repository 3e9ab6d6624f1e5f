#include "apps/mbk/options/measure_options.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/mbk/options/robot_file.h"
#include "apps/mbk/options/threads_option.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/units.h"
#include "mbk/present/report/ranges_text.h"

namespace mbk::app {

namespace {

void add_range_options(Command command, std::set<PlausibleQuantity>& ignored) {
  const char* const group = "Plausibility";
  const std::vector<std::string> names(kWordList<PlausibleQuantity>.begin(), kWordList<PlausibleQuantity>.end());
  command
      .add_option_function(
          "--ignore-range",
          [&ignored](const std::vector<std::string>& given) {
            for (const std::string& name : given) ignored.insert(*value_of<PlausibleQuantity>(name));
          },
          "plausible ranges that are not checked, by name, as in --ignore-range stiffness,motion")
      .type_name("NAMES")
      .delimiter(',')
      .allow_extra_args(false)
      .check(one_of(names))
      .group(group);
  command
      .add_text_flag("--ranges", report::ranges_text,
                     "print the ranges that a hand or a joint must keep to, with where they come from")
      .group(group);
}

}  // namespace

void add_measure_options(Command command, MeasureArguments& arguments) {
  add_reading_options(command, arguments.reading);
  add_sensor_options(command, arguments.sensor);
  add_protocol_options(command, arguments.preprocess);
  command.add_flag("--pool", arguments.pool, "one fit over all FILEs; otherwise one result each and a summary")
      .group("Analysed interval");
  add_signal_options(command, arguments.preprocess);
  add_identify_options(command, arguments.identify);
  add_range_options(command, arguments.ignored_ranges);
  add_threads_option(command, arguments.threads, "files measured").group("Model");
}

Result<measurement::Options> measurement_options(const MeasureArguments& arguments, const AnalyseArguments& analyse,
                                                 bool draws_arm) {
  const PreprocessArguments& a = arguments.preprocess;
  const auto signals = MBK_TRY(signal_options(a.window, a.filters));
  if (a.procedure && a.mode != Mode::reference) {
    return bad_usage(fmt::format("--procedure {} belongs to --mode reference", word_of(*a.procedure)),
                     "add that, or leave --procedure out");
  }
  if (!analyse.arm.empty() && analyse.domain != Domain::joint && !draws_arm) {
    return bad_usage("--arm belongs to --domain joint, or to --report, which draws it", "add one, or leave --arm out");
  }
  measurement::Options options;
  options.joint_domain = analyse.domain == Domain::joint;
  options.preprocess = signals;
  preprocess::Options& p = options.preprocess;
  p.mode = a.mode;
  p.procedure = a.procedure.value_or(Procedure::chapter3);
  p.protocol = a.protocol;
  p.axes = arguments.reading.axes;
  p.acceleration = a.acceleration;
  p.force_source = a.force_source;
  if (p.force_source != ForceSource::sensor) {
    auto robot = robot_of(a.robot);
    if (!robot) return tl::unexpected(robot.error());
    p.robot = std::make_shared<const robot::DynamicModel>(std::move(*robot));
  } else if (a.robot) {
    return bad_usage("--robot belongs to --force-source virtual or observer", "add that, or leave --robot out");
  }
  if (a.force_delay_ms != 0.0 && p.force_source != ForceSource::sensor) {
    return bad_usage("--force-delay-ms belongs to a force that was measured", "leave it out");
  }
  options.force_delay = a.force_delay_ms / kMilliseconds;
  if (a.force_rotation_deg != 0.0 && p.force_source != ForceSource::sensor) {
    return bad_usage("--force-rotation-deg belongs to a force that was measured", "leave it out");
  }
  options.force_rotation = a.force_rotation_deg / kDegrees;
  options.identify = arguments.identify;
  options.ignored_ranges = arguments.ignored_ranges;
  if (a.filters.resample_hz) options.resample = Hertz(*a.filters.resample_hz);
  return options;
}

ReadingArguments reading_for(ReadingArguments reading, const measurement::Options& options) {
  const auto& robot = options.preprocess.robot;
  if (robot) reading.joints = robot->mechanism->joint_names();
  return reading;
}

}  // namespace mbk::app
