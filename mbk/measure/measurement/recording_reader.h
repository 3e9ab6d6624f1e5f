#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/in_memory.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/calibration/sensor_force.h"
#include "mbk/model/trial/file_contents.h"
#include "mbk/model/trial/recording.h"

namespace mbk::measurement {

/// The recordings to read, and how.
struct Reading {
  std::vector<std::filesystem::path> files;
  bool parts = false;                            ///< they are numbered parts of one record
  recording::ReadOptions options;                ///< without `trial` all trials of each file
  std::optional<calibration::SensorUse> sensor;  ///< the force is that of its voltages
  /// A recording in memory under the name of a file, or null. May be empty.
  std::function<std::shared_ptr<const recording::InMemory>(const std::filesystem::path&)> in_memory;
};

/// Reads recordings one by one, also from several threads: only those in use are in memory. Every file is opened only
/// once. If it cannot be opened, the function that reads it reports the error.
class RecordingReader {
 public:
  /// @fails  usage: `parts` with a trial or with arrays in memory; a trial that is not there.
  [[nodiscard]] static Result<RecordingReader> open(const Reading& reading);

  /// Recordings: one for each file, or for each of its trials if it holds several; of parts one.
  [[nodiscard]] int count() const { return parts_ ? 1 : static_cast<int>(records_.size()); }
  /// The file, or the first part.
  [[nodiscard]] const std::filesystem::path& file(int k) const { return record(k).file; }
  /// Its trial by name; "" if the file holds one record only.
  [[nodiscard]] const std::string& trial(int k) const { return record(k).trial; }
  /// The trials of the only file, if it holds several and all of them are read; otherwise none.
  [[nodiscard]] std::vector<recording::TrialName> trials() const;

  /// @param k  0 … count() − 1    @fails  as recording::read; the error names the file.
  [[nodiscard]] Result<Recording> read(int k) const;
  /// The same for whoever measures it: of a session's recording only the perturbation.
  /// @fails  as read and preprocess::check_consent
  [[nodiscard]] Result<Recording> read_perturbation(int k) const;
  /// Contents of the file under its own names.   @fails  as recording::list_contents
  [[nodiscard]] Result<FileContents> list_contents(int k) const;
  /// The same with all numbers.   @fails  as recording::read_contents
  [[nodiscard]] Result<recording::Contents> read_contents(int k) const;

  /// Whether the file is the journal of a session, which `read` refuses.
  [[nodiscard]] bool is_journal(int k) const { return record(k).is_journal; }
  /// Whether the file holds several trials or arms.
  [[nodiscard]] bool of_trials(int k) const;

 private:
  struct Record {
    std::filesystem::path file;
    std::string trial = {};                                     ///< "": the only one of the file
    std::shared_ptr<const recording::RecordingFile> open = {};  ///< null: `refused`
    std::shared_ptr<const recording::InMemory> in_memory = {};  ///< in place of a file
    std::optional<Error> refused = {};                          ///< why it cannot be opened, for whoever reads it
    bool is_journal = false;                                    ///< of a session, which `mbk recover` reads
  };
  [[nodiscard]] static Result<std::vector<Record>> records_of(const std::filesystem::path& file,
                                                              const Reading& reading);
  [[nodiscard]] const Record& record(int k) const { return records_[static_cast<std::size_t>(k)]; }
  [[nodiscard]] recording::ReadOptions options_of(int k) const;
  [[nodiscard]] Result<Recording> read_stored(int k) const;

  std::vector<Record> records_;
  bool parts_ = false;
  recording::ReadOptions options_;
  std::optional<calibration::SensorUse> sensor_;
};

}  // namespace mbk::measurement
