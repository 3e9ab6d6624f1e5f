#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/store/store_values.h"

namespace mbk::store {

struct Database;
class FolderLock;

/// A file that was copied into the study's folder and is not yet part of it. It goes away unless it is added.
class IncomingFile {
 public:
  IncomingFile(IncomingFile&&) noexcept;
  IncomingFile& operator=(IncomingFile&&) = delete;
  ~IncomingFile();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] const std::string& sha256() const { return sha256_; }
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  friend class Store;
  IncomingFile();
  std::unique_ptr<FolderLock> lock_;
  std::filesystem::path path_;
  std::string sha256_, extension_;
  std::int64_t bytes_ = 0;
};

/// What became of a recording that was added.
struct AddedRecording {
  StoredRecording recording;
  bool there_before = false;
};

/// What `Store::forget` erased.
struct Forgotten {
  std::int64_t recordings = 0, results = 0, files = 0;
  std::vector<std::int64_t> lines_with_reasons;  ///< of the log: what was written of these recordings stays in it
  bool log_of_changes_emptied = true;  ///< false: another process was reading, so that erased pages stand in the
                                       ///< database's write-ahead log until the next command
};

/// What `Store::check` found.
struct CheckReport {
  std::int64_t recordings = 0, files = 0, bytes = 0, results = 0, log_lines = 0;
  std::int64_t repeated = 0;          ///< results that were measured again and are the same; the store repeats none
  std::string head;                   ///< hash of the log's last line
  std::vector<std::string> problems;  ///< one sentence each; empty: everything is as it was stored
  std::vector<std::string> notes;     ///< what was tidied up, or may be
};

/// What `verify_log` found.
struct LogVerdict {
  std::int64_t lines = 0;
  std::string head;
  std::vector<std::string> problems;
};

/// A study's folder: study.sqlite, and the recordings by their hash. Several processes may use it at once. Whatever
/// ends a process, and whenever, what was reported as stored is stored, and nothing is there by half. For one thread at
/// a time.
class Store {
 public:
  /// Makes a study in a folder that is not there yet, or is empty.
  /// @fails  usage: there is something in the folder. data: it cannot be written.
  [[nodiscard]] static Result<void> create(const std::filesystem::path& folder, const StudyFacts& facts, Role role);

  /// A study that may not be written is read as it is at this moment; what would change it then fails.
  /// @param waiting  is called once if another process holds the study for longer than a moment
  /// @fails  usage: there is no study. data: it cannot be read, is damaged, or was made by a newer mbk.
  [[nodiscard]] static Result<Store> open(const std::filesystem::path& folder, std::function<void()> waiting = {});

  Store(Store&&) noexcept;
  Store& operator=(Store&&) = delete;
  ~Store();

  [[nodiscard]] const std::filesystem::path& folder() const;

  [[nodiscard]] Result<StudyFacts> facts() const;
  /// Replaces the options that recordings are measured with by default.
  [[nodiscard]] Result<void> set_options(const std::string& options, Role role);

  /// Copies a file into the folder, under a name that nothing refers to, while it is hashed.
  /// @fails  data: it cannot be read; the folder cannot be written, the disk is full.
  [[nodiscard]] Result<IncomingFile> bring_in(const std::filesystem::path& file) const;
  /// The same with another end of its name.
  [[nodiscard]] Result<IncomingFile> bring_in(const std::filesystem::path& file, const std::string& extension) const;

  /// The recordings of a file with that hash, or made of one with that hash.
  [[nodiscard]] Result<std::vector<StoredRecording>> recordings_of(const std::string& sha256) const;

  /// Makes the file part of the study, with the recordings that it holds, or finds that it is there already.
  /// @param origin_sha256  of the file that `incoming` was made of; its own where it is a copy
  /// @fails  usage: facts that are out of range. data: it is there with other facts; it cannot be written.
  [[nodiscard]] Result<std::vector<AddedRecording>> add(IncomingFile incoming, std::span<const NewRecording> recordings,
                                                        const std::string& origin_sha256, Role role);

  /// By their numbers.
  [[nodiscard]] Result<std::vector<StoredRecording>> recordings() const;
  /// @fails  usage: no recording has that number.
  [[nodiscard]] Result<StoredRecording> recording(std::int64_t number) const;

  /// @fails  usage: there is no such recording; it is excluded already; the reason is empty.
  [[nodiscard]] Result<void> exclude(std::int64_t number, const std::string& why, Role role);
  /// Takes that back.   @fails  usage: it is not excluded.
  [[nodiscard]] Result<void> include(std::int64_t number, const std::string& why, Role role);

  /// In the order in which they were first used.
  [[nodiscard]] Result<std::vector<Analysis>> analyses() const;
  /// The one that the newest result is of; nothing where there is no result.
  [[nodiscard]] Result<std::optional<Analysis>> latest_analysis() const;

  /// What has no result with these options and this version and is not excluded, in the order of their keys.
  /// @param again_failed  also what could not be measured
  [[nodiscard]] Result<std::vector<Unit>> pending(const std::string& options, const std::string& version,
                                                  bool again_failed) const;
  /// Every unit of an analysis that has a result, in the order of their keys.
  [[nodiscard]] Result<std::vector<Unit>> measured(std::int64_t analysis) const;

  /// Stores results all together or not at all. What is there already stays; a recording that was forgotten in the
  /// meantime is passed over.
  /// @param results  as long as `units`    @returns  how many were new
  [[nodiscard]] Result<int> save(const std::string& options, const std::string& version, std::span<const Unit> units,
                                 std::span<const UnitResult> results, Role role);

  /// Of one analysis, by the numbers of the recordings.
  [[nodiscard]] Result<std::vector<StoredResult>> results(std::int64_t analysis) const;
  /// Of one recording, by the numbers of the analyses.
  [[nodiscard]] Result<std::vector<StoredResult>> results_of(std::int64_t recording) const;
  [[nodiscard]] Result<std::vector<Outcome>> outcomes(std::int64_t result) const;
  /// The result as JSON; empty where it could not be measured.
  [[nodiscard]] Result<std::string> document(std::int64_t result) const;
  [[nodiscard]] Result<std::string> document(const Unit& unit, std::int64_t analysis) const;

  /// Of usable results of recordings that are not excluded.
  [[nodiscard]] Result<OutcomeColumns> columns(std::int64_t analysis) const;

  /// Erases a participant's recordings and results, and keeps the fact in the log.
  /// @fails  usage: there is no such participant; the reason is empty.
  [[nodiscard]] Result<Forgotten> forget(std::int64_t participant, const std::string& why, Role role);

  [[nodiscard]] Result<std::vector<LogLine>> log() const;
  /// That no line of the log was changed, taken out or put in between.
  /// @param noted_head  hash of a line, noted elsewhere: it must still be there; "" for none
  [[nodiscard]] Result<LogVerdict> verify_log(const std::string& noted_head) const;

  /// That every file has its hash, the database is sound, and the log tells of everything that is there and of nothing
  /// that is not. Removes what an interrupted process left half-written.
  /// @param remove_leftovers  also whole files that no recording refers to
  /// @param progress  is told of each file: how many are done, of how many
  [[nodiscard]] Result<CheckReport> check(bool remove_leftovers, const std::function<void(int, int)>& progress);

  /// Copies the study, the log included, to a folder that is not there yet; it appears there when it is whole, and was
  /// checked.
  /// @param link  recordings become further names of the same files where the file system can
  /// @returns  what was found in the copy
  [[nodiscard]] Result<CheckReport> backup(const std::filesystem::path& to, bool link);

 private:
  explicit Store(std::unique_ptr<Database> database);
  std::unique_ptr<Database> database_;
};

/// The numbers of a result (schema mbk.result/2), by name.
/// @fails  data: not such a document.
[[nodiscard]] Result<std::vector<Outcome>> outcomes_of(std::string_view document);

/// A study in `from` or the nearest folder above it; nothing where there is none.
[[nodiscard]] std::optional<std::filesystem::path> find_study(const std::filesystem::path& from);

}  // namespace mbk::store
