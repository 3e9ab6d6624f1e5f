#include <algorithm>
#include <memory>

#include "apps/mbk/commands.h"
#include "apps/mbk/output_options.h"
#include "apps/mbk/reading_options.h"
#include "mbk/files/journal/journal.h"
#include "mbk/files/recording/inspect.h"
#include "mbk/files/recording/read.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

struct InfoArguments {
  ReadingArguments reading;
  SensorArguments sensor;
  OutputArguments output;
};

/// A file that is sound but speaks of no channel still shows what it holds; everything else is an error.
int list_unrecognised(const InfoArguments& arguments, const Error& error) {
  if (error.kind != ErrorKind::data || arguments.reading.files.size() != 1 || !arguments.reading.channels.empty()) {
    return report_error(error);
  }
  const auto contents = recording::list_contents(arguments.reading.files.front());
  if (!contents) return report_error(error);
  const std::string text =
      arguments.output.json ? result::to_json(*contents, error) : report::contents_text(*contents, error);
  if (auto ok = arguments.output.to.write(text); !ok) return report_error(ok.error());
  return kFine;
}

/// What a journal holds so far, as the recording that it would become.
Result<std::vector<Result<Recording>>> read_journal(const std::filesystem::path& file) {
  const auto journal = journal::read(file);
  if (!journal) return tl::unexpected(journal.error());
  auto recording = journal::to_recording(*journal);
  if (!recording) return tl::unexpected(recording.error().in(file.string()));
  recording->sources.push_back({file.string(), "journal of a session", ""});
  recording->notes.emplace_back("'mbk recover' makes a recording of it");
  std::vector<Result<Recording>> one;
  one.push_back(std::move(*recording));
  return one;
}

Result<std::vector<Result<Recording>>> read_each(const InfoArguments& arguments) {
  const auto reader = RecordingReader::of(arguments.reading, arguments.sensor);
  if (!reader) return tl::unexpected(reader.error());
  std::vector<Result<Recording>> each;
  for (int k = 0; k < reader->count(); ++k) each.push_back(reader->read(k));
  return each;
}

int run(const InfoArguments& arguments) {
  if (auto ok = arguments.output.to.check(arguments.reading.files); !ok) return report_error(ok.error());
  const bool journal = arguments.reading.files.size() == 1 && journal::is_journal(arguments.reading.files.front());
  auto each = journal ? read_journal(arguments.reading.files.front()) : read_each(arguments);
  if (!each) return report_error(each.error());
  if (each->size() == 1 && !each->front() && !journal) return list_unrecognised(arguments, each->front().error());
  int code = kFine;
  std::vector<Recording> recordings;
  std::vector<Inspection> inspections;
  for (Result<Recording>& one : *each) {
    if (!one) {
      code = std::max(code, report_error(one.error()));
      continue;
    }
    inspections.push_back(recording::inspect(*one));
    recordings.push_back(std::move(*one));
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
  if (auto ok = arguments.output.to.write(text); !ok) return report_error(ok.error());
  return code;
}

}  // namespace

Action add_info(CLI::App& app) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App* command = add_command(app, "info", "what is in a recording: channels, rate, gaps, problems");
  command->footer(
      "Examples:\n"
      "  mbk info log.mat\n"
      "      where no channel is recognised, the variables or columns of the file are listed\n"
      "  mbk info --parts log_1.mat log_2.mat\n"
      "  mbk info --channels time=1,x=2:mm,F=3 --axes 1 trial.csv\n\n"
      "Nothing is repaired: gaps, repeated or backward time and non-finite values are reported.");
  add_reading_options(*command, arguments->reading);
  add_sensor_options(*command, arguments->sensor);
  add_output_options(*command, arguments->output, "mbk.info/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
