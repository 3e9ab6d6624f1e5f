#include "apps/mbk/options/reading_options.h"

#include <fmt/format.h>

#include <filesystem>

#include "apps/mbk/caller.h"
#include "apps/mbk/options/option_checks.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/formats.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/preprocess/exclusions.h"

namespace mbk::app {
namespace {

Result<recording::ReadOptions> read_options(const ReadingArguments& arguments) {
  recording::ReadOptions options;
  if (!arguments.channels.empty()) {
    options.channels = MBK_TRY(recording::parse_channel_map(arguments.channels));
  }
  if (arguments.rate_hz) options.rate = Hertz(*arguments.rate_hz);
  options.axes = arguments.axes;
  options.untimed = arguments.untimed;
  options.own_samples = !arguments.as_recorded;
  options.commands = arguments.commands;
  options.variable = arguments.variable;
  options.clock = arguments.clock;
  options.trial = arguments.trial;
  options.arm = arguments.arm;
  options.requested = arguments.requested;
  options.joints = arguments.joints;
  return options;
}

/// All of them, or the first error.
Result<std::vector<Recording>> all_of(const ReadingArguments& arguments, const SensorArguments& with_sensor,
                                      Result<Recording> (RecordingReader::*read)(int) const) {
  const auto reader = MBK_TRY(open_recordings(arguments, with_sensor));
  std::vector<Recording> recordings;
  for (int k = 0; k < reader.count(); ++k) {
    auto one = MBK_TRY((reader.*read)(k));
    recordings.push_back(std::move(one));
  }
  return recordings;
}

}  // namespace

void add_reading_options(Command command, ReadingArguments& arguments) {
  command.add_option("FILE", arguments.files, "recordings: " + recording::readable_files()).required();
  command
      .add_option("--channels", arguments.channels,
                  "where the channels stand, where the file does not say it itself: x=2,y=3,Fx=10,Fy=11 names columns "
                  "(or rows of a wide matrix, or names in the file); x=pos[1],Fx=force[1] takes them from several "
                  "matrices, x=data[trial,:,1] a slice of an array of trials; x=Arm.angle is a channel of a stream; "
                  "x=2:mm converts, Fx=-10 flips. Channels: time, x, "
                  "y, Fx, Fy, xr, yr, q1 to q8, tau1 to "
                  "tau8, qr1 to qr8, ax, ay, Vx, Vy; one axis: time, x, F, xr, a; for mbk tf: input, output")
      .type_name("MAP")
      .check(not_empty());
  command.add_option("--variable", arguments.variable, "which variable of a MAT file, where several could be meant")
      .type_name("NAME")
      .check(not_empty());
  command
      .add_option("--trial", arguments.trial,
                  "which trial of a file or folder that holds several, by its number or name; otherwise all of them")
      .type_name("N|NAME")
      .check(not_empty());
  command
      .add_option("--side", arguments.arm, "whose hand is the hand, where a KINARM exam recorded both: right or left")
      .type_name("right|left")
      .check([](const std::string& arm) {
        return arm == "right" || arm == "left" ? "" : fmt::format("{} is neither right nor left", quoted(arm));
      });
  command
      .add_option(
          "--clock", arguments.clock,
          "the stream or topic whose time stamps the recording has, where its channels come from several: those "
          "of the others are interpolated linearly")
      .type_name("STREAM")
      .check(not_empty());
  command.add_option("--rate", arguments.rate_hz, "sample rate, where the file holds no time")
      .type_name("HZ")
      .check(positive());
  command.add_option("--axes", arguments.axes, "1 or 2; otherwise by the channels that are there")
      .type_name("N")
      .check([](const std::string& n) {
        return n == "1" || n == "2" ? "" : fmt::format("{} is neither 1 nor 2", quoted(n));
      });
  command.add_flag("--parts", arguments.parts, "the FILEs are numbered parts of one record: join them");
}

Result<RecordingReader> open_recordings(const ReadingArguments& arguments, const SensorArguments& with_sensor) {
  measurement::Reading reading;
  reading.files = arguments.files;
  reading.parts = arguments.parts;
  reading.options = MBK_TRY(read_options(arguments));
  reading.sensor = MBK_TRY(sensor_use(with_sensor));
  reading.in_memory = recording_in_memory;
  return RecordingReader::open(reading);
}

Result<std::vector<Recording>> read_recordings(const ReadingArguments& arguments, const SensorArguments& with_sensor) {
  return all_of(arguments, with_sensor, &RecordingReader::read);
}

Result<std::vector<Recording>> read_perturbations(const ReadingArguments& arguments,
                                                  const SensorArguments& with_sensor) {
  return all_of(arguments, with_sensor, &RecordingReader::read_perturbation);
}

void say_exclusions(const Recording& recording, bool leaves_windows_out) {
  const std::string exclusions = preprocess::exclusions_text(recording);
  if (exclusions.empty()) return;
  say("mbk: {}: the operator said of this recording: {}; {}\n",
      recording.sources.empty() ? "recording" : recording.sources.front().label(), exclusions,
      leaves_windows_out ? "windows are left out" : "nothing is left out here: --from and --to can");
}

}  // namespace mbk::app
