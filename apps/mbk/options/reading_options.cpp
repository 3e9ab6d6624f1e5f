#include "apps/mbk/options/reading_options.h"

#include "apps/mbk/options/table_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/files/recording/formats.h"
#include "mbk/measure/preprocess/exclusions.h"

namespace mbk::app {

void add_files_option(Command command, ReadRequest& reading) {
  command.add_option("FILE", reading.files, "recordings: " + recording::readable_files()).required();
}

void add_reading_options(Command command, ReadRequest& reading) {
  add_files_option(command, reading);
  add_options(command, request::read_table(), reading);
}

void add_sensor_options(Command command, SensorRequest& sensor) {
  add_options(command, request::sensor_table(), sensor);
}

void say_exclusions(const Recording& recording, bool leaves_windows_out) {
  const std::string exclusions = preprocess::exclusions_text(recording);
  if (exclusions.empty()) return;
  say("mbk: {}: the operator noted: {}; {}\n",
      recording.sources.empty() ? "recording" : recording.sources.front().label(), exclusions,
      leaves_windows_out ? "windows are excluded" : "nothing is excluded here; use --from and --to");
}

}  // namespace mbk::app
