#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output_options.h"
#include "apps/mbk/options/reading_options.h"
#include "mbk/files/journal/journal.h"
#include "mbk/files/recording/formats.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/analyse/plausible_scale.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

struct InfoArguments {
  ReadRequest reading;
  SensorRequest sensor;
  OutputArguments output;
  bool formats = false;
};

/// The formats that are read, one line each.
std::string formats_text() {
  std::string text = fmt::format("{:<13}{:<24}{}\n", "format", "usual extensions", "versions; written by");
  for (const recording::FileFormat& format : recording::file_formats()) {
    text += fmt::format("{:<13}{:<24}{}\n", format.name, format.extensions, format.about);
  }
  return text + "The format is recognised by the content of a file, not by its name.\n";
}

/// Lists the contents of an intact file without recognised channels; everything else is an error.
int list_unrecognised(const InfoArguments& arguments, const RecordingReader& reader, const Error& error,
                      const std::string& before = "") {
  if (arguments.reading.files.size() != 1 || !arguments.reading.channels.empty()) return report_error(error);
  const bool no_arm = error.kind == ErrorKind::usage && reader.of_trials(0) && arguments.reading.options.arm.empty();
  if (error.kind != ErrorKind::data && !no_arm) return report_error(error);
  const auto contents = reader.list_contents(0);
  if (!contents) return report_error(error);
  const std::string text =
      arguments.output.json ? result::to_json(*contents, error) : before + report::contents_text(*contents, error);
  if (auto ok = arguments.output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return error.code == recording::kUnbelievableTime ? kBadData : kFine;
}

/// The contents of a journal so far, as the recording that it would become.
Result<Recording> read_journal(const std::filesystem::path& file) {
  const auto journal = journal::read(file);
  if (!journal) return tl::unexpected(journal.error());
  auto recording = journal::to_recording(*journal);
  if (!recording) return tl::unexpected(recording.error().in(file.string()));
  recording->sources.push_back({file.string(), "journal of a session", ""});
  recording->notes.emplace_back("'mbk recover' makes a recording of it");
  return recording;
}

/// Inspects a recording, and adds a note if its values are implausible for a limb.
Inspection inspected(Recording& recording) {
  Inspection inspection = recording::inspect(recording);
  if (const auto size = analyse::check_size(recording, inspection)) {
    recording.notes.push_back(fmt::format("{}; {}", size->message, size->remedy));
  }
  return inspection;
}

/// The contents of a file with several trials: all of them by name, and one in full.
int show_trials(const InfoArguments& arguments, const RecordingReader& reader,
                const std::vector<recording::TrialName>& trials) {
  std::vector<std::pair<std::string, std::string>> names;
  for (const recording::TrialName& trial : trials) names.emplace_back(trial.name, trial.description);
  const std::string list =
      report::trials_text(arguments.reading.files.front().string(), names) + "\nThe first trial:\n";
  auto first = reader.read(0);
  if (!first) return list_unrecognised(arguments, reader, first.error(), list);
  const Inspection inspection = inspected(*first);
  const std::string text = list + report::info_text(*first, inspection);
  if (auto ok = arguments.output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return kFine;
}

int run(const InfoArguments& arguments) {
  const ReadRequest& reading = arguments.reading;
  if (arguments.formats) {
    if (auto ok = arguments.output.write(formats_text(), {}); !ok) return report_error(ok.error());
    return kFine;
  }
  if (reading.files.empty()) {
    return report_error({ErrorKind::usage, "FILE is missing", "name a recording; see 'mbk info --help'", ""});
  }
  if (auto ok = arguments.output.to.check(reading.files); !ok) return report_error(ok.error());
  int code = kFine;
  std::vector<Recording> recordings;  // of several, without their samples
  std::vector<Inspection> inspections;
  const auto add = [&](Recording recording) {
    inspections.push_back(inspected(recording));
    for (Channel& channel : recording.channels) channel.values.resize(0);
    recording.time.resize(0);
    recordings.push_back(std::move(recording));
  };
  const auto reader = open_recordings(reading, arguments.sensor);
  if (!reader) return report_error(reader.error());
  if (reader->count() == 1 && reader->is_journal(0)) {
    auto recording = read_journal(reading.files.front());
    if (!recording) return report_error(recording.error());
    add(std::move(*recording));
  } else {
    const std::vector<recording::TrialName> trials = reader->trials();
    if (!trials.empty() && reading.files.size() == 1 && !arguments.output.json) {
      return show_trials(arguments, *reader, trials);
    }
    for (int k = 0; k < reader->count(); ++k) {
      auto one = reader->read(k);
      if (one) {
        add(std::move(*one));
      } else if (reader->count() == 1) {
        return list_unrecognised(arguments, *reader, one.error());
      } else {
        code = std::max(code, report_error(one.error()));
      }
    }
  }
  if (recordings.empty()) return code;
  std::string text;
  if (arguments.output.json) {
    text = result::to_json(recordings, inspections);
  } else {
    for (std::size_t i = 0; i < inspections.size(); ++i) {
      text += (i > 0 ? "\n" : "") + report::info_text(recordings[i], inspections[i]);
    }
  }
  if (auto ok = arguments.output.write(text, arguments.reading.files); !ok) return report_error(ok.error());
  return code;
}

}  // namespace

Action add_info(Command app) {
  auto arguments = std::make_shared<InfoArguments>();
  const Command command = app.add_command("info", "list the channels, rate, gaps and problems of a recording");
  command.footer(
      "Examples:\n"
      "  mbk info log.mat\n"
      "      if no channel is recognised, the variables or columns of the file are listed\n"
      "  mbk info --parts log_1.mat log_2.mat\n"
      "  mbk info exam.kinarm\n"
      "      lists all trials and shows the first; --trial 3 shows another\n"
      "  mbk info --channels time=1,x=2:mm,F=3 --axes 1 trial.csv\n"
      "  mbk info --formats\n"
      "      lists every format that mbk reads\n\n"
      "Nothing is repaired: gaps, repeated or backward time and non-finite values are reported.");
  arguments->reading.options.own_samples = false;
  arguments->reading.options.emg = recording::EmgReading::same_clock;
  add_reading_options(command, arguments->reading);
  command.get_option("FILE").required(false);
  command.add_flag("--formats", arguments->formats, "list the formats that mbk reads");
  add_sensor_options(command, arguments->sensor);
  add_output_options(command, arguments->output, "mbk.info/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
