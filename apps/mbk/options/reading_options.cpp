#include "apps/mbk/options/reading_options.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <system_error>

#include "apps/mbk/terminal/memory.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/journal/journal.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/files/recording/formats.h"
#include "mbk/files/recording/in_memory.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/measure/preprocess/perturbation_only.h"

namespace mbk::app {
namespace {

/// Whether a file holds more than some minutes.
bool is_long(const std::filesystem::path& file) {
  constexpr std::uintmax_t kLong = std::uintmax_t{32} << 20;
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(file, none);
  return !none && size > kLong;
}

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
  options.arm = arguments.arm;
  options.requested = arguments.requested;
  options.joints = arguments.joints;
  return options;
}

/// All of them, or the first error.
Result<std::vector<Recording>> all_of(const ReadingArguments& arguments, const SensorArguments& with_sensor,
                                      Result<Recording> (RecordingReader::*read)(int) const) {
  const auto reader = MBK_TRY(RecordingReader::of(arguments, with_sensor));
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

Result<RecordingReader> RecordingReader::of(const ReadingArguments& arguments, const SensorArguments& with_sensor) {
  auto options = MBK_TRY(read_options(arguments));
  auto sensor = MBK_TRY(sensor_use(with_sensor));
  RecordingReader reader;
  if (arguments.parts && !arguments.trial.empty()) {
    return bad_usage("--parts joins files of one record each, --trial takes one of several in a file",
                     "leave one of them out");
  }
  constexpr std::size_t kMany = 64;  // files that a process may well hold open
  const bool many = arguments.files.size() > kMany;
  for (const std::filesystem::path& file : arguments.files) {
    if (arguments.parts && recording::held_recording(file)) {
      return fail(ErrorKind::usage, "--parts joins files, and this is in memory", "join the arrays instead",
                  file.string());
    }
    auto records = MBK_TRY(arguments.parts ? Result<std::vector<Record>>({{file, ""}})
                                           : records_of(file, arguments.trial, options));
    if (many && !arguments.parts) {
      for (const Record& one : records) {
        if (one.open) recording::rest(*one.open);
      }
    }
    reader.records_.insert(reader.records_.end(), records.begin(), records.end());
  }
  reader.parts_ = arguments.parts;
  reader.options_ = std::move(options);
  reader.sensor_ = std::move(sensor);
  return reader;
}

Result<std::vector<RecordingReader::Record>> RecordingReader::records_of(const std::filesystem::path& file,
                                                                         const std::string& trial,
                                                                         const recording::ReadOptions& options) {
  if (auto given = recording::held_recording(file)) return std::vector<Record>{{file, trial, {}, std::move(given)}};
  auto open = recording::open(file);
  if (!open) {  // reported by whoever reads it
    Record record{file, "", {}, {}, open.error(), journal::is_journal(file)};
    if (record.is_journal) {
      record.refused = Error{ErrorKind::data, "is the journal of a session that was cut off, or is still running",
                             fmt::format("'mbk recover {}' makes a recording of it", file.string()), file.string()};
    }
    return std::vector<Record>{std::move(record)};
  }
  const std::vector<recording::TrialName> trials = recording::trials_of(**open, options);
  const auto in_file = [&](tl::unexpected<Error> error) { return tl::unexpected(error.value().in(file.string())); };
  if (trials.empty() && !trial.empty()) {
    // A slice that is wrong is why there are no trials.
    MBK_TRY(options.channels.empty() ? Result<Recording>(Recording{}) : recording::read(**open, options));
    return in_file(bad_usage(fmt::format("--trial {}: the file holds one record only", trial), "leave --trial out"));
  }
  std::vector<Record> records;
  if (trials.empty()) records.push_back({file, "", *open});
  for (const recording::TrialName& one : trials) {
    if (trial.empty() || one.name == trial) records.push_back({file, one.name, *open});
  }
  if (!records.empty()) return records;
  return in_file(bad_usage(fmt::format("there is no trial '{}'", trial),
                           fmt::format("there are {} trials, {} to {}; 'mbk info' lists them", trials.size(),
                                       trials.front().name, trials.back().name)));
}

std::vector<recording::TrialName> RecordingReader::trials() const {
  if (parts_ || records_.size() < 2 || records_.front().file != records_.back().file || !records_.front().open) {
    return {};
  }
  const std::vector<recording::TrialName> trials = recording::trials_of(*records_.front().open, options_);
  return trials.size() == records_.size() ? trials : std::vector<recording::TrialName>();
}

Result<Recording> RecordingReader::read(int k) const {
  auto one = read_stored(k);
  if (one && sensor_) {
    one = calibration::force_from_voltage(std::move(*one), *sensor_);
    if (!one) one = tl::unexpected(one.error().in(file(k).string()));
  }
  return one;
}

Result<Recording> RecordingReader::read_stored(int k) const {
  if (const auto& given = record(k).in_memory) {
    auto recording = given->read(options_of(k));
    if (!recording) return tl::unexpected(recording.error().in(file(k).string()));
    if (recording->sources.empty()) recording->sources.push_back({file(k).string(), "arrays in memory", ""});
    return recording;
  }
  if (is_long(file(k))) give_back_large_blocks();
  const recording::ReadOptions options = options_of(k);
  if (parts_) return recording::read_parts(files(), options);
  if (record(k).refused) return tl::unexpected(*record(k).refused);
  return recording::read(*record(k).open, options);
}

Result<FileContents> RecordingReader::list_contents(int k) const {
  if (record(k).refused) return tl::unexpected(*record(k).refused);
  if (!record(k).open) return bad_data("it is no file whose contents could be listed", "", file(k).string());
  return recording::list_contents(*record(k).open, options_of(k));
}

bool RecordingReader::of_trials(int k) const {
  return record(k).open && !recording::trials_of(*record(k).open).empty();
}

Result<recording::Contents> RecordingReader::read_contents(int k) const {
  if (const auto& given = record(k).in_memory) return given->contents();
  if (record(k).refused) return tl::unexpected(*record(k).refused);
  return recording::read_contents(*record(k).open, options_of(k));
}

recording::ReadOptions RecordingReader::options_of(int k) const {
  recording::ReadOptions options = options_;
  options.trial = record(k).trial;
  return options;
}

std::vector<std::filesystem::path> RecordingReader::files() const {
  std::vector<std::filesystem::path> files;
  for (const Record& record : records_) files.push_back(record.file);
  return files;
}

Result<Recording> RecordingReader::read_perturbation(int k) const {
  auto one = MBK_TRY(read(k));
  const auto withdrawn = one.metadata.find("withdrawn");
  if (withdrawn != one.metadata.end() && withdrawn->second == "yes") {
    return bad_data("the person has withdrawn: these data must not be used", "leave the file out, and remove it",
                    one.sources.empty() ? "" : one.sources.front().label());
  }
  return preprocess::perturbation_only(std::move(one));
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
