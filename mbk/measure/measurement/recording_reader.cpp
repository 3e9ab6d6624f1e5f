#include "mbk/measure/measurement/recording_reader.h"

#include <fmt/format.h>

#include <utility>

#include "mbk/files/journal/journal.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/measure/preprocess/perturbation_only.h"

namespace mbk::measurement {

namespace fs = std::filesystem;

Result<RecordingReader> RecordingReader::open(const Reading& reading) {
  if (reading.parts && !reading.options.trial.empty()) {
    return bad_usage("--parts and --trial exclude each other: one joins files, the other selects a trial of a file",
                     "omit one of them");
  }
  constexpr std::size_t kMany = 64;  // files that a process may well hold open
  const bool many = reading.files.size() > kMany;
  RecordingReader reader;
  reader.parts_ = reading.parts;
  reader.options_ = reading.options;
  reader.options_.trial.clear();
  reader.sensor_ = reading.sensor;
  for (const fs::path& file : reading.files) {
    auto records = MBK_TRY(records_of(file, reading));
    for (Record& one : records) {
      if (many && one.open) recording::rest(*one.open);
      reader.records_.push_back(std::move(one));
    }
  }
  return reader;
}

Result<std::vector<RecordingReader::Record>> RecordingReader::records_of(const fs::path& file, const Reading& reading) {
  const std::string& trial = reading.options.trial;
  if (auto given = reading.in_memory ? reading.in_memory(file) : nullptr) {
    if (!reading.parts) return std::vector<Record>{{.file = file, .trial = trial, .in_memory = std::move(given)}};
    return fail(ErrorKind::usage, "--parts joins files, and this is in memory", "join the arrays instead",
                file.string());
  }
  if (reading.parts) return std::vector<Record>{{.file = file}};
  auto open = recording::open(file);
  if (!open) {
    Record record{.file = file, .refused = open.error(), .is_journal = journal::is_journal(file)};
    if (record.is_journal) {
      record.refused = Error{ErrorKind::data, "is the journal of a session that was cut off, or is still running",
                             fmt::format("'mbk recover {}' makes a recording of it", file.string()), file.string()};
    }
    return std::vector<Record>{std::move(record)};
  }
  recording::ReadOptions all = reading.options;
  all.trial.clear();
  const std::vector<recording::TrialName> trials = recording::trials_of(**open, all);
  const auto in_file = [&](tl::unexpected<Error> error) { return tl::unexpected(error.value().in(file.string())); };
  if (trials.empty() && !trial.empty()) {
    // A slice that is wrong is why there are no trials.
    MBK_TRY(all.channels.empty() ? Result<Recording>(Recording{}) : recording::read(**open, all));
    return in_file(bad_usage(fmt::format("--trial {}: the file contains only one recording", trial), "omit --trial"));
  }
  std::vector<Record> records;
  if (trials.empty()) records.push_back({.file = file, .open = *open});
  for (const recording::TrialName& one : trials) {
    if (trial.empty() || one.name == trial) records.push_back({.file = file, .trial = one.name, .open = *open});
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
  if (!one || !sensor_) return one;
  one = calibration::force_from_voltage(std::move(*one), *sensor_);
  if (!one) return tl::unexpected(one.error().in(file(k).string()));
  return one;
}

Result<Recording> RecordingReader::read_stored(int k) const {
  const recording::ReadOptions options = options_of(k);
  if (parts_) {
    std::vector<fs::path> files;
    for (const Record& part : records_) files.push_back(part.file);
    return recording::read_parts(std::move(files), options);
  }
  const Record& one = record(k);
  if (one.refused) return tl::unexpected(*one.refused);
  if (one.open) return recording::read(*one.open, options);
  auto recording = one.in_memory->read(options);
  if (!recording) return tl::unexpected(recording.error().in(one.file.string()));
  if (recording->sources.empty()) recording->sources.push_back({one.file.string(), "arrays in memory", ""});
  return recording;
}

Result<Recording> RecordingReader::read_perturbation(int k) const {
  auto one = MBK_TRY(read(k));
  if (auto ok = preprocess::check_consent(one); !ok) {
    return tl::unexpected(one.sources.empty() ? ok.error() : ok.error().in(one.sources.front().label()));
  }
  return preprocess::perturbation_only(std::move(one));
}

Result<FileContents> RecordingReader::list_contents(int k) const {
  const Record& one = record(k);
  if (one.refused) return tl::unexpected(*one.refused);
  if (!one.open) return bad_data("it is no file whose contents could be listed", "", one.file.string());
  return recording::list_contents(*one.open, options_of(k));
}

Result<recording::Contents> RecordingReader::read_contents(int k) const {
  const Record& one = record(k);
  if (one.in_memory) return one.in_memory->contents();
  if (one.refused) return tl::unexpected(*one.refused);
  if (!one.open) return bad_data("it is one of several parts", "", one.file.string());
  return recording::read_contents(*one.open, options_of(k));
}

bool RecordingReader::of_trials(int k) const {
  return record(k).open && !recording::trials_of(*record(k).open).empty();
}

recording::ReadOptions RecordingReader::options_of(int k) const {
  recording::ReadOptions options = options_;
  options.trial = record(k).trial;
  return options;
}

}  // namespace mbk::measurement
