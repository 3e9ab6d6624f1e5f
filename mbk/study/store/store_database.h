#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/store/store_values.h"

/// How the database of a study is reached; nobody outside of this module sees it.
namespace mbk::store {

inline constexpr const char* kDatabaseName = "study.sqlite";
inline constexpr const char* kRecordingsName = "recordings";

/// The connection to a study's database. It stays where it is: SQLite knows its address.
struct Database {
  std::filesystem::path folder;
  std::function<void()> waiting;  ///< as Store::open
  bool read_only = false;         ///< the study may not be written
  SQLite::Database connection;

  /// The connection with everything set that this module takes for granted.   @throws SQLite::Exception
  Database(const std::filesystem::path& in, int flags, const std::string& name = kDatabaseName,
           std::function<void()> on_waiting = {});
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  ~Database() = default;

  /// The database of a study that may not be written, as it is at this moment. SQLite cannot join others that use it
  /// then, so that this is a copy in memory.
  /// @fails  data: it cannot be read; another process has changes in its log; it changes all the time.
  [[nodiscard]] static Result<std::unique_ptr<Database>> snapshot(const std::filesystem::path& folder);

 private:
  static int wait(void* database, int count);
  std::chrono::steady_clock::time_point wait_began_;
  bool told_ = false;
};

/// What went wrong, where, and what to do about it.
[[nodiscard]] Error error_of(const SQLite::Exception& exception, const std::filesystem::path& folder);

/// Gives what `work` gives, a Result; what SQLite throws in it becomes an Error.
template <class Work>
auto guarded(const std::filesystem::path& folder, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const SQLite::Exception& exception) {
    return tl::unexpected(error_of(exception, folder));
  }
}

inline void bind_one(SQLite::Statement& statement, int at, const std::string& text) {
  statement.bind(at, text);
}
inline void bind_one(SQLite::Statement& statement, int at, std::int64_t number) {
  statement.bind(at, number);
}
inline void bind_one(SQLite::Statement& statement, int at, double number) {
  statement.bind(at, number);
}
template <class Value>
void bind_one(SQLite::Statement& statement, int at, const std::optional<Value>& value) {
  if (value) {
    bind_one(statement, at, *value);
  } else {
    statement.bind(at);
  }
}

/// Values for the question marks of a statement, from the first on.
template <class... Values>
void bind_all(SQLite::Statement& statement, const Values&... values) {
  int at = 0;
  (bind_one(statement, ++at, values), ...);
}

/// A statement that gives no rows.   @returns  how many rows it changed
template <class... Values>
int execute(SQLite::Database& connection, const char* sql, const Values&... values) {
  SQLite::Statement statement(connection, sql);
  bind_all(statement, values...);
  return statement.exec();
}

/// A statement with its values.
template <class... Values>
SQLite::Statement query(const SQLite::Database& connection, const char* sql, const Values&... values) {
  SQLite::Statement statement(connection, sql);
  bind_all(statement, values...);
  return statement;
}

inline std::string text_at(const SQLite::Statement& row, int column) {
  return row.getColumn(column).getString();
}
inline std::int64_t number_at(const SQLite::Statement& row, int column) {
  return row.getColumn(column).getInt64();
}
inline std::optional<std::int64_t> optional_number_at(const SQLite::Statement& row, int column) {
  return row.getColumn(column).isNull() ? std::nullopt : std::optional(number_at(row, column));
}

/// A transaction that keeps others from writing from its begin on. What is not committed is taken back, also where
/// there is no memory left, in which SQLite::Transaction would end the program.
class WriteTransaction {
 public:
  explicit WriteTransaction(SQLite::Database& connection, const char* begin = "BEGIN IMMEDIATE")
      : connection_(connection) {
    connection_.exec(begin);
  }
  WriteTransaction(const WriteTransaction&) = delete;
  WriteTransaction& operator=(const WriteTransaction&) = delete;
  ~WriteTransaction() {
    if (!committed_) sqlite3_exec(connection_.getHandle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
  void commit() {
    connection_.exec("COMMIT");
    committed_ = true;
  }

 private:
  SQLite::Database& connection_;
  bool committed_ = false;
};

/// Brings the tables to those of this version, from nothing or from those of an older one.
/// @fails  data: they are those of a newer one, or of another program.
[[nodiscard]] Result<void> migrate(SQLite::Database& connection, const std::filesystem::path& folder);

/// SHA-256 of a text, 64 hexadecimal digits.
[[nodiscard]] std::string sha256_of(const std::string& text);

/// Now, UTC: "2026-05-04T09:30:12Z".
[[nodiscard]] std::string utc_now();

/// 32 hexadecimal digits that nobody can guess.
[[nodiscard]] std::string new_salt();

/// Appends a line to the log; number, time and hash are made here. Within the transaction of what it tells of.
void append_to_log(SQLite::Database& connection, LogLine line);

/// The hash of a line that follows one with the hash `before`.
[[nodiscard]] std::string hash_of(const LogLine& line, const std::string& before);

/// Calls `take` for every line, in order.
template <class Take>
void for_each_line(const SQLite::Database& connection, const Take& take) {
  SQLite::Statement rows(connection,
                         "SELECT number, time, role, action, recording, analysis, participant, digest, why, hash "
                         "FROM log ORDER BY number");
  while (rows.executeStep()) {
    LogLine line;
    line.number = number_at(rows, 0);
    line.time = text_at(rows, 1);
    const auto role = value_of<Role>(text_at(rows, 2));
    const auto action = value_of<LoggedAction>(text_at(rows, 3));
    line.role = role.value_or(static_cast<Role>(-1));
    line.action = action.value_or(static_cast<LoggedAction>(-1));
    line.recording = optional_number_at(rows, 4);
    line.analysis = optional_number_at(rows, 5);
    line.participant = optional_number_at(rows, 6);
    line.digest = text_at(rows, 7);
    line.why = text_at(rows, 8);
    line.hash = text_at(rows, 9);
    take(line);
  }
}

/// A recording and the salt of its digests.
struct SaltedRecording {
  StoredRecording recording;
  std::string salt;
};

/// The columns that `recording_at` reads.
inline constexpr const char* kRecordingColumns =
    "number, sha256, part, extension, bytes, participant, session, trial, condition, duration_s, added, "
    "origin_sha256, excluded_why, salt, rater";

[[nodiscard]] SaltedRecording recording_at(const SQLite::Statement& row);

/// What a line of the log says of a recording or a result, so that any change of it shows.
[[nodiscard]] std::string digest_of(const SaltedRecording& recording);
[[nodiscard]] std::string digest_of(const std::string& salt, const std::string& options_sha256,
                                    const std::string& version, const UnitResult& result);

/// Stores the numbers of a result in one row: their names and units are those of a layout, the row has the values and
/// then the standard errors (NaN: none), 8 bytes each, little-endian.
void pack_outcomes(SQLite::Database& connection, std::int64_t result, const std::vector<Outcome>& outcomes);

/// Packs those of every document.   @fails  data: a document that is none
[[nodiscard]] Result<void> pack_all_outcomes(SQLite::Database& connection);

/// The numbers of a result; nothing where there are none, or what is there is no layout and its numbers.
[[nodiscard]] std::vector<Outcome> unpacked_outcomes(const SQLite::Database& connection, std::int64_t result);

/// Removes the files of forgotten recordings that are still there, however the process ended that forgot them.
/// Under a lock that keeps others from adding.   @returns  how many
[[nodiscard]] Result<std::int64_t> finish_erasing(Database& database);

/// Whether a forgotten recording's file is still there.
[[nodiscard]] bool is_erasing(const Database& database);

}  // namespace mbk::store
