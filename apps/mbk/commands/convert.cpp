#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/readers_option.h"
#include "apps/mbk/options/reading_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/trial_files.h"
#include "mbk/files/recording/write.h"
#include "mbk/files/recording/write_bids.h"
#include "mbk/files/recording/write_contents.h"

namespace mbk::app {
namespace {

struct ConvertArguments {
  ReadRequest reading;  ///< its files: those to read, and last the one to write
  SensorRequest sensor;
  std::string format, bids;
  bool overwrite = false, quiet = false;
  std::optional<Readers> readers;
};

Result<void> check_files(const std::vector<std::filesystem::path>& inputs, const Output& output, bool parts,
                         bool to_data_set) {
  if (inputs.empty()) return bad_usage("one file is named, but two are needed", "write mbk convert IN OUT");
  if (inputs.size() > 1 && !parts) {
    return bad_usage(fmt::format("{} input files are named for one output file", inputs.size()),
                     "pass --parts if they are numbered parts of one recording, or convert each one separately");
  }
  if (to_data_set) return {};
  std::error_code code;
  if (std::filesystem::is_directory(*output.file, code)) {
    return fail(ErrorKind::usage, "this is a folder",
                "name a file, or pass the BIDS name of the recording: --bids sub-07_task-reach_run-1",
                output.file->string());
  }
  return check_new_file(*output.file, "OUT", output.overwrite, inputs);
}

/// The one recording that is converted.
Result<Recording> read_one(const ReadRequest& reading, const SensorRequest& sensor) {
  const auto reader = MBK_TRY(open_recordings(reading, sensor));
  if (reader.count() > 1) {
    return fail(ErrorKind::usage,
                fmt::format("the file contains {} recordings, but only one can be converted", reader.count()),
                "choose one with --trial; 'mbk info' lists them", reading.files.front().string());
  }
  return reader.read(0);
}

/// "log.h5: HDF5, 62.1 s, 6 channels, 2 events, 9 entries of metadata".
std::string summary_line(const Recording& recording, const std::filesystem::path& file, std::string_view format) {
  const auto count = [](std::size_t n, std::string_view one, std::string_view more) {
    return fmt::format("{} {}", n, n == 1 ? one : more);
  };
  return fmt::format("{}: {}, {:.6g} s, {}, {}, {} of metadata\n", file.string(), format,
                     recording.time[recording.samples() - 1] - recording.time[0],
                     count(recording.channels.size(), "channel", "channels"),
                     count(recording.events.size(), "event", "events"),
                     count(recording.metadata.size(), "entry", "entries"));
}

/// Reports what was not written, the notes of reading, and the file that was written.
int report(const ConvertArguments& arguments, const Recording& recording, const std::filesystem::path& file,
           std::string_view format, const std::vector<std::string>& lost,
           const std::function<void(const std::string&)>& say_note) {
  for (const std::string& one : lost) say("mbk: {}: not written: {}\n", file.string(), one);
  if (arguments.quiet) return kFine;
  for (const std::string& note : recording.notes) say_note(note);
  if (auto ok = print_text(summary_line(recording, file, format)); !ok) return report_error(ok.error());
  return kFine;
}

/// The inputs and the output format of a conversion.
struct Conversion {
  const ConvertArguments& arguments;
  recording::Format format;
  RecordingReader reader;
};

/// "mbk: log.mat: …", or of a trial "mbk: exam.zip, trial 3: …".
void say_of(const Conversion& job, int k, std::string_view note) {
  const std::string& trial = job.reader.trial(k);
  say("mbk: {}{}: {}\n", job.reader.file(k).string(), trial.empty() ? "" : ", trial " + trial, note);
}

/// Copies every array unchanged if no channel is recognised.
int copy_arrays(const Conversion& job, int k, const std::filesystem::path& file, const Error& unrecognised) {
  const auto contents = job.reader.read_contents(k);
  if (!contents) return report_error(contents.error());
  if (contents->arrays.empty()) return report_error(unrecognised);
  const auto said = recording::write_contents(*contents, file, job.format, job.arguments.overwrite,
                                              job.arguments.readers.value_or(Readers::owner));
  if (!said) return report_error(said.error());
  say_of(job, k,
         fmt::format("{}: every array was copied unchanged, under its own name and in its own unit",
                     unrecognised.message.substr(0, unrecognised.message.find(';'))));
  for (const std::string& one : *said) say("mbk: {}: {}\n", file.string(), one);
  if (job.arguments.quiet) return kFine;
  for (const std::string& note : contents->notes) say_of(job, k, note);
  const std::size_t count = contents->arrays.size();
  const std::string line = fmt::format("{}: {}, {} {} copied unchanged\n", file.string(), recording::text(job.format),
                                       count, count == 1 ? "array" : "arrays");
  if (auto ok = print_text(line); !ok) return report_error(ok.error());
  return kFine;
}

int convert_one(const Conversion& job, int k, const std::filesystem::path& file) {
  const auto recording = job.reader.read(k);
  if (!recording) {
    const ReadRequest& reading = job.arguments.reading;
    const bool whole =
        reading.channels.empty() && !reading.parts && recording.error().code == recording::kNothingRecognised;
    return whole ? copy_arrays(job, k, file, recording.error()) : report_error(recording.error());
  }
  const Readers readers = job.arguments.readers.value_or(Readers::owner);
  if (auto ok = recording::write(*recording, file, job.format, job.arguments.overwrite, readers); !ok) {
    return report_error(ok.error());
  }
  return report(job.arguments, *recording, file, recording::text(job.format),
                recording::lost_in(*recording, job.format), [&](const std::string& note) { say_of(job, k, note); });
}

/// Adds the recording to a data set.
int run_bids(const ConvertArguments& arguments, const std::filesystem::path& folder) {
  if (!arguments.format.empty()) {
    return report_error(bad_usage("--bids and --format name two formats", "omit one of the two").value());
  }
  const auto recording = read_one(arguments.reading, arguments.sensor);
  if (!recording) return report_error(recording.error());
  const auto motion = recording::write_bids(*recording, folder, arguments.bids, arguments.overwrite,
                                            arguments.readers.value_or(Readers::owner));
  if (!motion) return report_error(motion.error());
  const auto say_note = [&](const std::string& note) {
    say("mbk: {}: {}\n", arguments.reading.files.front().string(), note);
  };
  return report(arguments, *recording, *motion, "BIDS motion", recording::lost_in_bids(*recording), say_note);
}

int run(ConvertArguments arguments) {
  ReadRequest& reading = arguments.reading;
  Output output;
  output.file = reading.files.back();
  output.overwrite = arguments.overwrite;
  reading.files.pop_back();
  if (auto ok = check_files(reading.files, output, reading.parts, !arguments.bids.empty()); !ok) {
    return report_error(ok.error());
  }
  if (!arguments.bids.empty()) return run_bids(arguments, *output.file);
  const auto format = recording::format_of(*output.file, arguments.format);
  if (!format) return report_error(format.error());
  auto reader = open_recordings(reading, arguments.sensor);
  if (!reader) return report_error(reader.error());
  std::vector<std::string> trials;
  for (int k = 0; k < reader->count(); ++k) trials.push_back(reader->trial(k));
  const auto files = recording::files_of_trials(*output.file, trials);
  if (!files) return report_error(files.error());
  for (const std::filesystem::path& file : *files) {
    if (auto ok = check_new_file(file, "OUT", output.overwrite, reading.files); !ok) return report_error(ok.error());
  }
  const Conversion job{arguments, *format, std::move(*reader)};
  int code = kFine;
  for (int k = 0; k < job.reader.count(); ++k) {
    code = std::max(code, convert_one(job, k, (*files)[static_cast<std::size_t>(k)]));
  }
  return code;
}

}  // namespace

Action add_convert(Command app) {
  auto arguments = std::make_shared<ConvertArguments>();
  const Command command =
      app.add_command("convert", "convert a recording to another format: HDF5, MAT, CSV, C3D, BIDS");
  command.footer(
      "Examples:\n"
      "  mbk convert log.mat log.h5\n"
      "      the extension of the second name determines the format: .h5 (or .hdf5), .mat (v5), .csv or .c3d\n"
      "  mbk convert trial.csv trial.mat --format mat73\n"
      "  mbk convert --parts log_1.mat log_2.mat log_3.mat whole.h5\n"
      "  mbk convert log.h5 data_set --bids sub-07_ses-2_task-reach_run-1\n"
      "      adds the recording to a BIDS data set (Motion), or creates one\n"
      "  mbk convert drive.csv drive.h5 --channels time=1:ms,x=2:mm,F=-3 --axes 1\n"
      "      converts units and signs: the file is in SI units\n"
      "  mbk convert exam.zip out_{trial}.h5\n"
      "      writes one file for each of several trials; {trial} stands for its name (--trial selects one)\n"
      "  mbk convert other.mat other.csv\n"
      "      if no channel is recognised, every array is copied unchanged, under its own name and in its own unit\n\n"
      "Numbers are preserved to the last bit, with units, frames, events and metadata (C3D rounds them\n"
      "to single precision and needs an even clock). Nothing is resampled or repaired. What was ignored\n"
      "in reading, or cannot be stored in the new format, is reported on standard error.");
  arguments->reading.options.own_samples = false;
  arguments->reading.options.emg = recording::EmgReading::same_clock;
  add_reading_options(command, arguments->reading);
  add_sensor_options(command, arguments->sensor);
  command.get_option("FILE").description("the recording to read (several with --parts), then the file to write");
  command.add_option("--format", arguments->format, "format of the file to write (default: from its extension)")
      .type_name(fmt::format("{}", fmt::join(kWordList<recording::Format>, "|")))
      .check(not_empty());
  command
      .add_option("--bids", arguments->bids,
                  "name of the recording in a BIDS data set, of which the last FILE is the folder: "
                  "sub-LABEL[_ses-LABEL]_task-LABEL[_tracksys-LABEL][_acq-LABEL][_run-NUMBER]")
      .type_name("NAME")
      .check(not_empty());
  command.add_flag("--overwrite", arguments->overwrite, "replace an existing file");
  add_readers_option(command, arguments->readers);
  command.add_flag("--quiet", arguments->quiet, "report only what is lost");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
