#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "apps/mbk/commands.h"
#include "apps/mbk/messages.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/output.h"
#include "apps/mbk/readers_option.h"
#include "apps/mbk/reading_options.h"
#include "mbk/files/recording/write.h"

namespace mbk::app {
namespace {

struct ConvertArguments {
  ReadingArguments reading;  ///< its files: those to read, and last the one to write
  SensorArguments sensor;
  std::string format;
  bool overwrite = false, quiet = false;
  std::optional<Readers> readers;
};

Result<void> check_files(const std::vector<std::filesystem::path>& inputs, const Output& output, bool parts) {
  if (inputs.empty()) return bad_usage("one file is named where two are needed", "mbk convert IN OUT");
  if (inputs.size() > 1 && !parts) {
    return bad_usage(fmt::format("{} files to read, and one to write", inputs.size()),
                     "pass --parts where they are numbered parts of one record, else convert each one separately");
  }
  return check_new_file(*output.file, "OUT", output.overwrite, inputs);
}

/// "log.h5: HDF5, 62.1 s, 6 channels, 2 events, 9 entries of metadata".
std::string summary_line(const Recording& recording, const std::filesystem::path& file, recording::Format format) {
  const auto count = [](std::size_t n, std::string_view one, std::string_view more) {
    return fmt::format("{} {}", n, n == 1 ? one : more);
  };
  return fmt::format("{}: {}, {:.6g} s, {}, {}, {} of metadata\n", file.string(), recording::text(format),
                     recording.time[recording.samples() - 1] - recording.time[0],
                     count(recording.channels.size(), "channel", "channels"),
                     count(recording.events.size(), "event", "events"),
                     count(recording.metadata.size(), "entry", "entries"));
}

int run(ConvertArguments arguments) {
  ReadingArguments& reading = arguments.reading;
  Output output;
  output.file = reading.files.back();
  output.overwrite = arguments.overwrite;
  reading.files.pop_back();
  if (auto ok = check_files(reading.files, output, reading.parts); !ok) return report_error(ok.error());
  const auto format = recording::format_of(*output.file, arguments.format);
  if (!format) return report_error(format.error());
  const auto recordings = read_recordings(reading, arguments.sensor);
  if (!recordings) return report_error(recordings.error());
  const Recording& recording = recordings->front();
  const Readers readers = arguments.readers.value_or(Readers::owner);
  if (auto ok = recording::write(recording, *output.file, *format, output.overwrite, readers); !ok) {
    return report_error(ok.error());
  }
  for (const std::string& lost : recording::lost_in(recording, *format)) {
    say("mbk: {}: not written: {}\n", output.file->string(), lost);
  }
  if (arguments.quiet) return kFine;
  for (const std::string& note : recording.notes) say("mbk: {}: {}\n", reading.files.front().string(), note);
  if (auto ok = Output().write(summary_line(recording, *output.file, *format)); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_convert(CLI::App& app) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = add_command(app, "convert", "a recording in another format: HDF5, MAT, CSV, MCAP");
  command->footer(
      "Examples:\n"
      "  mbk convert log.mat log.h5\n"
      "      the end of the second name says the format: .h5 (or .hdf5), .mat (v5), .csv or .mcap (for\n"
      "      Foxglove and PlotJuggler)\n"
      "  mbk convert trial.csv trial.mat --format mat73\n"
      "  mbk convert --parts log_1.mat log_2.mat log_3.mat whole.h5\n"
      "  mbk convert drive.csv drive.h5 --channels time=1:ms,x=2:mm,F=-3 --axes 1\n"
      "      units and signs are put right on the way: what is written is SI\n\n"
      "Numbers come over to the last bit, with units, frames, events and metadata. Nothing is resampled or repaired.\n"
      "What was ignored in reading, or has no place in the new format, is said on standard error.");
  add_reading_options(*command, arguments->reading);
  add_sensor_options(*command, arguments->sensor);
  command->get_option("FILE")->description("the recording to read (several with --parts), and last the one to write");
  command->add_option("--format", arguments->format, "of the file to write; otherwise by the end of its name")
      ->type_name(fmt::format("{}", fmt::join(kWordList<recording::Format>, "|")))
      ->check(not_empty());
  command->add_flag("--overwrite", arguments->overwrite, "replace the file to write where it is there");
  add_readers_option(*command, arguments->readers);
  command->add_flag("--quiet", arguments->quiet, "only say what is lost");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
