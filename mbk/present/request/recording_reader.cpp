#include "mbk/present/request/recording_reader.h"

#include <fmt/format.h>

#include <filesystem>

#include "mbk/files/journal/journal.h"
#include "mbk/files/recording/in_memory.h"
#include "mbk/measure/preprocess/perturbation_only.h"

namespace mbk::request {
namespace {

/// All of them, or the first error.
Result<std::vector<Recording>> all_of(const ReadRequest& request, const SensorRequest& with_sensor,
                                      Result<Recording> (RecordingReader::*read)(int) const) {
  const auto reader = MBK_TRY(RecordingReader::of(request, with_sensor));
  std::vector<Recording> recordings;
  for (int k = 0; k < reader.count(); ++k) {
    auto one = MBK_TRY((reader.*read)(k));
    recordings.push_back(std::move(one));
  }
  return recordings;
}

}  // namespace

Result<RecordingReader> RecordingReader::of(const ReadRequest& request, const SensorRequest& with_sensor) {
  auto options = MBK_TRY(read_options(request));
  auto sensor = MBK_TRY(sensor_use(with_sensor));
  RecordingReader reader;
  if (request.parts && !request.options.trial.empty()) {
    return bad_usage("--parts joins files of one record each, --trial takes one of several in a file",
                     "leave one of them out");
  }
  constexpr std::size_t kMany = 64;  // files that a process may well hold open
  const bool many = request.files.size() > kMany;
  for (const std::filesystem::path& file : request.files) {
    if (request.parts && recording::held_recording(file)) {
      return fail(ErrorKind::usage, "--parts joins files, and this is in memory", "join the arrays instead",
                  file.string());
    }
    auto records = MBK_TRY(request.parts ? Result<std::vector<Record>>({{file, ""}})
                                         : records_of(file, request.options.trial, options));
    if (many && !request.parts) {
      for (const Record& one : records) {
        if (one.open) recording::rest(*one.open);
      }
    }
    reader.records_.insert(reader.records_.end(), records.begin(), records.end());
  }
  reader.parts_ = request.parts;
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

Result<std::vector<Recording>> read_recordings(const ReadRequest& request, const SensorRequest& with_sensor) {
  return all_of(request, with_sensor, &RecordingReader::read);
}

Result<std::vector<Recording>> read_perturbations(const ReadRequest& request, const SensorRequest& with_sensor) {
  return all_of(request, with_sensor, &RecordingReader::read_perturbation);
}

}  // namespace mbk::request
