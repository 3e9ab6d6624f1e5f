#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/calibration/sensor_force.h"
#include "mbk/model/trial/recording.h"
#include "mbk/present/request/read_request.h"
#include "mbk/present/request/sensor_request.h"

namespace mbk::recording {
class InMemory;
}

namespace mbk::request {

/// Reads the FILEs one by one, also from several threads at once: only what is being worked on has to be in memory.
class RecordingReader {
 public:
  /// @fails  usage: the options; the calibration of --sensor cannot be read.
  [[nodiscard]] static Result<RecordingReader> of(const ReadRequest& request, const SensorRequest& with_sensor = {});

  /// Recordings: one for each FILE, or for each of its trials where it holds several; with --parts one of all.
  [[nodiscard]] int count() const { return parts_ ? 1 : static_cast<int>(records_.size()); }
  /// FILE, or the first part.
  [[nodiscard]] const std::filesystem::path& file(int k) const { return records_[static_cast<std::size_t>(k)].file; }

  /// Its trial by name; "" where FILE holds one record only.
  [[nodiscard]] const std::string& trial(int k) const { return records_[static_cast<std::size_t>(k)].trial; }
  /// The trials of the only FILE, where it holds several and all of them are read; otherwise none.
  [[nodiscard]] std::vector<recording::TrialName> trials() const;

  /// Where --sensor is given, the force is that of its voltages.
  /// @param k  0 … count() − 1    @fails  as recording::read; the error names the file.
  [[nodiscard]] Result<Recording> read(int k) const;
  /// What the file holds under its own names.   @fails  as recording::list_contents
  [[nodiscard]] Result<FileContents> list_contents(int k) const;
  /// Whether FILE is the journal of a session, which `read` refuses.
  [[nodiscard]] bool is_journal(int k) const { return record(k).is_journal; }
  /// Whether FILE holds several trials or arms.
  [[nodiscard]] bool of_trials(int k) const;
  /// What stands in it, before anything is said about channels.   @fails  as recording::read_contents
  [[nodiscard]] Result<recording::Contents> read_contents(int k) const;
  /// As `read`, of a session's recording only the perturbation.   @fails  data: the person has withdrawn.
  [[nodiscard]] Result<Recording> read_perturbation(int k) const;

 private:
  struct Record {
    std::filesystem::path file;
    std::string trial;                                          ///< "": the only one of the file
    std::shared_ptr<const recording::RecordingFile> open = {};  ///< the file; nullptr: `refused`
    std::shared_ptr<const recording::InMemory> in_memory = {};  ///< in place of a file
    std::optional<Error> refused = {};                          ///< why it cannot be opened, for whoever reads it
    bool is_journal = false;                                    ///< of a session, which `mbk recover` reads
  };
  /// FILE as the records that it holds.
  [[nodiscard]] static Result<std::vector<Record>> records_of(const std::filesystem::path& file,
                                                              const std::string& trial,
                                                              const recording::ReadOptions& options);
  [[nodiscard]] const Record& record(int k) const { return records_[static_cast<std::size_t>(k)]; }

  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  [[nodiscard]] recording::ReadOptions options_of(int k) const;
  [[nodiscard]] Result<Recording> read_stored(int k) const;

  std::vector<Record> records_;
  bool parts_ = false;
  recording::ReadOptions options_;
  std::optional<calibration::SensorUse> sensor_;
};

/// Every FILE as a recording; with --parts all of them as one. Where --sensor is given, the force is that of its
/// voltages.
[[nodiscard]] Result<std::vector<Recording>> read_recordings(const ReadRequest& request,
                                                             const SensorRequest& with_sensor = {});

/// The same, of sessions' recordings only the perturbation.
/// @fails  as read_recordings; data: the person has withdrawn.
[[nodiscard]] Result<std::vector<Recording>> read_perturbations(const ReadRequest& request,
                                                                const SensorRequest& with_sensor = {});

}  // namespace mbk::request
