// Whether a study is as it was stored, forgetting, and copies of it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <string_view>
#include <system_error>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/study/store/store.h"
#include "mbk/study/store/store_database.h"
#include "mbk/study/store/store_files.h"

namespace mbk::store {
namespace {

namespace fs = std::filesystem;

/// What the log says of the content, line by line.
struct Told {
  std::map<std::int64_t, std::string> added;                              ///< recording → digest
  std::map<std::int64_t, std::optional<std::string>> excluded;            ///< why, or taken back
  std::map<std::pair<std::int64_t, std::int64_t>, std::string> measured;  ///< recording, analysis → digest
  std::set<std::int64_t> erased;
  std::string options_digest;

  void take(const LogLine& line) {
    const std::int64_t recording = line.recording.value_or(0);
    switch (line.action) {
      case LoggedAction::init:
      case LoggedAction::defaults:
        options_digest = line.digest;
        break;
      case LoggedAction::add:
        added[recording] = line.digest;
        break;
      case LoggedAction::measure:
        measured[{recording, line.analysis.value_or(0)}] = line.digest;
        break;
      case LoggedAction::exclude:
        excluded[recording] = line.why;
        break;
      case LoggedAction::include:
        excluded[recording] = std::nullopt;
        break;
      case LoggedAction::erase:
        erased.insert(recording);
        break;
      case LoggedAction::forget:
        break;
    }
  }
};

/// Since 1970, of a time as the log has it.
std::optional<std::chrono::seconds> seconds_of(const std::string& time) {
  constexpr std::string_view kForm = "0000-00-00T00:00:00Z";
  if (time.size() != kForm.size()) return std::nullopt;
  for (std::size_t k = 0; k < kForm.size(); ++k) {
    const bool digit = time[k] >= '0' && time[k] <= '9';
    if (kForm[k] == '0' ? !digit : time[k] != kForm[k]) return std::nullopt;
  }
  const auto number = [&](std::size_t at, std::size_t digits) {
    int value = 0;
    for (std::size_t k = at; k < at + digits; ++k) value = 10 * value + (time[k] - '0');
    return value;
  };
  const std::chrono::year_month_day day(std::chrono::year(number(0, 4)),
                                        std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                        std::chrono::day(static_cast<unsigned>(number(8, 2))));
  if (!day.ok()) return std::nullopt;
  return std::chrono::sys_days(day).time_since_epoch() + std::chrono::hours(number(11, 2)) +
         std::chrono::minutes(number(14, 2)) + std::chrono::seconds(number(17, 2));
}

/// The chain of the log, line by line.
class ChainReader {
 public:
  explicit ChainReader(std::string noted) : noted_(std::move(noted)) {}

  void take(const LogLine& line) {
    ++verdict.lines;
    if (line.number != verdict.lines && whole_) {
      say(fmt::format("line {} of the log is missing", verdict.lines));
    } else if (line.hash != hash_of(line, verdict.head) && whole_) {
      say(fmt::format("line {} of the log, or one before it, was changed", line.number));
    }
    take_time(line);
    verdict.head = line.hash;
    noted_found_ = noted_found_ || line.hash == noted_;
  }

  LogVerdict finished() {
    if (verdict.lines == 0) say("the log is empty");
    if (!noted_.empty() && !noted_found_) {
      say(fmt::format(
          "the log has no line with the hash {}: the head was mistyped, or the log was shortened or rewritten; "
          "compare the copy that you kept",
          noted_));
    }
    return std::move(verdict);
  }

  LogVerdict verdict;

 private:
  /// The computers that share a study have clocks that differ a little; a log never goes back further.
  void take_time(const LogLine& line) {
    constexpr std::chrono::seconds kClocksDiffer(60);
    const auto time = seconds_of(line.time);
    if (!time) {
      verdict.problems.push_back(fmt::format("line {} of the log has no time: '{}'", line.number, line.time));
    } else if (latest_ && *time + kClocksDiffer < *latest_) {
      verdict.problems.push_back(
          fmt::format("line {} of the log is dated {}, {} s before the line above it: a clock was set back, or the log "
                      "was rewritten",
                      line.number, line.time, (*latest_ - *time).count()));
    }
    if (time) latest_ = time;
  }

  void say(std::string problem) {
    verdict.problems.push_back(std::move(problem));
    whole_ = false;  // what follows the first broken line is broken as well
  }
  std::string noted_;
  std::optional<std::chrono::seconds> latest_;
  bool noted_found_ = false, whole_ = true;
};

class Checker {
 public:
  Checker(Database& database, CheckReport& report) : database_(database), report_(report) {}

  void check_database() {
    SQLite::Statement rows(database_.connection, "PRAGMA integrity_check(5)");
    while (rows.executeStep()) {
      if (const std::string said = text_at(rows, 0); said != "ok") problem("the database is damaged: " + said);
    }
    SQLite::Statement foreign(database_.connection, "PRAGMA foreign_key_check");
    while (foreign.executeStep()) problem("a row of the table " + text_at(foreign, 0) + " refers to no existing row");
  }

  void check_log() {
    ChainReader chain("");
    for_each_line(database_.connection, [&](const LogLine& line) {
      chain.take(line);
      told_.take(line);
    });
    LogVerdict verdict = chain.finished();
    report_.log_lines = verdict.lines;
    report_.head = verdict.head;
    for (std::string& said : verdict.problems) problem(std::move(said));
  }

  void check_recordings() {
    auto options = query(database_.connection, "SELECT value FROM fact WHERE name = 'options'");
    if (!options.executeStep() || sha256_of(text_at(options, 0)) != told_.options_digest) {
      problem("the study's default options differ from those in the log");
    }
    std::set<std::int64_t> there;
    auto rows =
        query(database_.connection, fmt::format("SELECT {} FROM recording ORDER BY number", kRecordingColumns).c_str());
    while (rows.executeStep()) {
      const SaltedRecording salted = recording_at(rows);
      const StoredRecording& one = salted.recording;
      ++report_.recordings;
      there.insert(one.number);
      files_.emplace(stored_name(one.sha256, one.extension), one);
      salts_[one.number] = salted.salt;
      const auto line = told_.added.find(one.number);
      if (line == told_.added.end() || line->second != digest_of(salted)) {
        problem(fmt::format("recording {} differs from the one added according to the log", one.number));
      }
      const auto excluded = told_.excluded.find(one.number);
      const auto why = excluded == told_.excluded.end() ? std::nullopt : excluded->second;
      if (why != one.excluded_why) {
        problem(fmt::format("recording {} was excluded or included without a line in the log", one.number));
      }
      if (told_.erased.contains(one.number))
        problem(fmt::format("recording {} was forgotten but still exists", one.number));
    }
    for (const auto& [number, digest] : told_.added) {
      if (!there.contains(number) && !told_.erased.contains(number)) {
        problem(fmt::format("recording {}, added according to the log, is missing", number));
      }
    }
  }

  void check_results() {
    std::set<std::pair<std::int64_t, std::int64_t>> there;
    SQLite::Statement rows(
        database_.connection,
        "SELECT result.number, recording, analysis, usable, failed, reason, options_sha256, version, "
        "coalesce(text, ''), options FROM result JOIN analysis ON analysis.number = analysis "
        "LEFT JOIN document ON document.result = result.number ORDER BY result.number");
    while (rows.executeStep()) {
      ++report_.results;
      const std::pair key{number_at(rows, 1), number_at(rows, 2)};
      there.insert(key);
      const UnitResult result{text_at(rows, 8), number_at(rows, 3) != 0, text_at(rows, 5)};
      const auto line = told_.measured.find(key);
      const auto salt = salts_.find(key.first);
      if (line == told_.measured.end() || salt == salts_.end() || sha256_of(text_at(rows, 9)) != text_at(rows, 6) ||
          line->second != digest_of(salt->second, text_at(rows, 6), text_at(rows, 7), result) ||
          (number_at(rows, 4) != 0) != result.document.empty()) {
        problem(fmt::format("the result of recording {}, analysis {}, differs from the one in the log", key.first,
                            key.second));
      } else if (!has_its_outcomes(number_at(rows, 0), result)) {
        problem(fmt::format("the numbers of recording {}, analysis {}, differ from its result", key.first, key.second));
      }
    }
    for (const auto& [key, digest] : told_.measured) {
      if (!there.contains(key) && !told_.erased.contains(key.first)) {
        problem(fmt::format("the result of recording {}, analysis {}, measured according to the log, is missing",
                            key.first, key.second));
      }
    }
  }

  void check_files(const std::function<void(int, int)>& progress) {
    int done = 0;
    for (const auto& [name, recording] : files_) {
      const auto found = files::file_sha256(database_.folder / name);
      if (found && *found == recording.sha256) {
        ++report_.files;
        report_.bytes += recording.bytes;
      } else if (is_still_there(recording)) {
        problem(found ? fmt::format("{}: its content differs from what was added", name) : found.error().line());
      }
      if (progress) progress(++done, static_cast<int>(files_.size()));
    }
  }

  /// What no row speaks of.
  Result<void> tidy(bool remove_leftovers) {
    if (database_.read_only) {
      note("the study is read-only, so leftovers of interrupted processes were not checked");
      return {};
    }
    // Nobody adds meanwhile: what is half-written now was left by a process that is gone.
    MBK_TRY(FolderLock::take(database_.folder, FolderLock::Kind::alone, database_.waiting));
    std::set<std::string> known;
    auto rows = query(database_.connection, "SELECT sha256, extension FROM recording");
    while (rows.executeStep()) known.insert(stored_name(text_at(rows, 0), text_at(rows, 1)));
    std::vector<fs::path> half, whole, foreign;
    std::error_code code;
    for (const auto& entry : fs::recursive_directory_iterator(database_.folder / kRecordingsName, code)) {
      if (entry.is_directory(code)) continue;
      const fs::path name = entry.path().lexically_relative(database_.folder);
      if (known.contains(name.generic_string())) continue;
      const std::string file = entry.path().filename().string();
      const std::string stem = file.substr(0, file.find('.'));
      const bool ours = stem.size() == 64 && stem.find_first_not_of("0123456789abcdef") == std::string::npos;
      (is_temporary(entry.path()) ? half : ours ? whole : foreign).push_back(entry.path());
    }
    for (const auto& entry : fs::directory_iterator(database_.folder, code)) {
      if (entry.path().filename().string().find(".part") != std::string::npos) half.push_back(entry.path());
    }
    for (const fs::path& file : half) {
      MBK_TRY(files::remove_file(file));
    }
    if (!half.empty()) note(fmt::format("{} removed: half-written by an interrupted process", count(half)));
    for (const fs::path& file : whole) {
      if (!remove_leftovers) continue;
      MBK_TRY(files::remove_file(file));
    }
    if (!whole.empty() && remove_leftovers) note(fmt::format("{} removed: no recording refers to it", count(whole)));
    if (!whole.empty() && !remove_leftovers) {
      note(
          fmt::format("{} that no recording refers to, from an interrupted 'add' or an older database: add the "
                      "recordings again, or remove leftovers with --remove-leftovers",
                      count(whole)));
    }
    if (!foreign.empty()) {
      note(fmt::format("{} in the folder of recordings not written by mbk", count(foreign)));
    }
    return {};
  }

 private:
  static std::string count(const std::vector<fs::path>& files) {
    return files.size() == 1 ? "1 file" : fmt::format("{} files", files.size());
  }

  /// It may have been forgotten since the rows were read.
  bool is_still_there(const StoredRecording& recording) {
    return query(database_.connection, "SELECT 1 FROM recording WHERE sha256 = ?", recording.sha256).executeStep();
  }

  bool has_its_outcomes(std::int64_t number, const UnitResult& result) {
    std::vector<Outcome> expected;
    if (!result.document.empty()) {
      auto read = outcomes_of(result.document);
      if (!read) return false;
      expected = std::move(*read);
    }
    return unpacked_outcomes(database_.connection, number) == expected;
  }

  void problem(std::string sentence) { report_.problems.push_back(printable(std::move(sentence))); }
  void note(std::string sentence) { report_.notes.push_back(std::move(sentence)); }

  Database& database_;
  CheckReport& report_;
  Told told_;
  std::map<std::string, StoredRecording> files_;  ///< one of the recordings of each
  std::map<std::int64_t, std::string> salts_;
};

}  // namespace

bool is_erasing(const Database& database) {
  return query(database.connection, "SELECT 1 FROM erasure LIMIT 1").executeStep();
}

Result<std::int64_t> finish_erasing(Database& database) {
  SQLite::Database& connection = database.connection;
  std::vector<std::string> names;
  {
    SQLite::Statement rows(connection, "SELECT file FROM erasure");
    while (rows.executeStep()) names.push_back(text_at(rows, 0));
  }
  std::int64_t count = 0;
  std::set<fs::path> folders;
  for (const std::string& name : names) {
    auto removed = MBK_TRY(files::remove_file(database.folder / name));
    count += removed ? 1 : 0;
    folders.insert((database.folder / name).parent_path());
  }
  for (const fs::path& folder : folders) {
    MBK_TRY(files::flush_folder(folder));
  }
  WriteTransaction transaction(connection);
  for (const std::string& name : names) execute(connection, "DELETE FROM erasure WHERE file = ?", name);
  transaction.commit();
  return count;
}

Result<Forgotten> Store::forget(std::int64_t participant, const std::string& why, Role role) {
  if (why.empty()) return bad_usage("the reason is missing", "give one; it stays in the log, so name nobody");
  MBK_TRY(FolderLock::take(folder(), FolderLock::Kind::alone, database_->waiting));
  return guarded(folder(), [&]() -> Result<Forgotten> {
    SQLite::Database& connection = database_->connection;
    Forgotten forgotten;
    {
      WriteTransaction transaction(connection);
      std::vector<std::int64_t> numbers;
      auto rows = query(connection, "SELECT number FROM recording WHERE participant = ? ORDER BY number", participant);
      while (rows.executeStep()) numbers.push_back(number_at(rows, 0));
      if (numbers.empty()) {
        return bad_usage(fmt::format("there is no recording of participant {}", participant),
                         "'mbk study list' shows the existing ones");
      }
      rows.reset();
      auto results = query(connection,
                           "SELECT count(*) FROM result JOIN recording ON recording.number = recording "
                           "WHERE participant = ?",
                           participant);
      results.executeStep();
      forgotten.results = number_at(results, 0);
      results.reset();
      forgotten.recordings = std::ssize(numbers);
      for_each_line(connection, [&](const LogLine& line) {
        const bool theirs = line.recording && std::ranges::binary_search(numbers, *line.recording);
        if (theirs && !line.why.empty()) forgotten.lines_with_reasons.push_back(line.number);
      });
      LogLine line{.role = role, .action = LoggedAction::forget};
      line.participant = participant;
      line.why = why;
      append_to_log(connection, line);
      for (const std::int64_t number : numbers) {
        LogLine erase{.role = role, .action = LoggedAction::erase};
        erase.recording = number;
        append_to_log(connection, erase);
      }
      // A file that holds trials of others too stays.
      execute(
          connection,
          "INSERT OR IGNORE INTO erasure SELECT 'recordings/' || substr(sha256, 1, 2) || '/' || sha256 || extension "
          "FROM recording WHERE participant = ?1 AND sha256 NOT IN "
          "(SELECT sha256 FROM recording WHERE participant != ?1)",
          participant);
      execute(connection, "DELETE FROM recording WHERE participant = ?", participant);
      transaction.commit();
    }
    auto files = MBK_TRY(finish_erasing(*database_));
    forgotten.files = files;
    connection.exec("VACUUM");
    auto emptied = query(connection, "PRAGMA wal_checkpoint(TRUNCATE)");
    emptied.executeStep();
    forgotten.log_of_changes_emptied = number_at(emptied, 0) == 0;
    return forgotten;
  });
}

Result<std::vector<LogLine>> Store::log() const {
  return guarded(folder(), [&]() -> Result<std::vector<LogLine>> {
    std::vector<LogLine> lines;
    for_each_line(database_->connection, [&](const LogLine& line) { lines.push_back(line); });
    return lines;
  });
}

Result<LogVerdict> Store::verify_log(const std::string& noted_head) const {
  return guarded(folder(), [&]() -> Result<LogVerdict> {
    ChainReader chain(noted_head);
    for_each_line(database_->connection, [&](const LogLine& line) { chain.take(line); });
    return chain.finished();
  });
}

Result<CheckReport> Store::check(bool remove_leftovers, const std::function<void(int, int)>& progress) {
  return guarded(folder(), [&]() -> Result<CheckReport> {
    CheckReport report;
    Checker checker(*database_, report);
    {
      const WriteTransaction snapshot(database_->connection, "BEGIN DEFERRED");  // which only reads
      checker.check_database();
      checker.check_log();
      checker.check_recordings();
      checker.check_results();
    }
    checker.check_files(progress);
    MBK_TRY(checker.tidy(remove_leftovers));
    return report;
  });
}

}  // namespace mbk::store
