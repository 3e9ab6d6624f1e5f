#include "mbk/study/store/store_database.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <nlohmann/json.hpp>
#include <random>
#include <span>
#include <thread>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/study/store/store_files.h"

namespace mbk::store {
namespace {

using Json = nlohmann::json;

constexpr const char* kInMemory = ":memory:";
constexpr int kApplication = 0x6d626b73;  // "mbks"

/// From the tables of version i to those of version i + 1; 0 is an empty database.
constexpr std::array kMigrations = {
    R"(
CREATE TABLE fact(name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE recording(
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  sha256 TEXT NOT NULL, part INTEGER NOT NULL, extension TEXT NOT NULL, bytes INTEGER NOT NULL,
  participant INTEGER NOT NULL CHECK (participant > 0), session INTEGER NOT NULL CHECK (session > 0),
  trial INTEGER NOT NULL CHECK (trial > 0), condition TEXT NOT NULL, duration_s REAL NOT NULL, added TEXT NOT NULL,
  origin_sha256 TEXT NOT NULL, excluded_why TEXT, salt TEXT NOT NULL,
  UNIQUE (sha256, part)) STRICT;
CREATE INDEX recording_origin ON recording(origin_sha256);
CREATE INDEX recording_whose ON recording(participant, session, condition, trial);
CREATE TABLE analysis(
  number INTEGER PRIMARY KEY, options_sha256 TEXT NOT NULL, options TEXT NOT NULL, version TEXT NOT NULL,
  UNIQUE (options_sha256, version)) STRICT;
CREATE TABLE result(
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  recording INTEGER NOT NULL REFERENCES recording(number) ON DELETE CASCADE,
  analysis INTEGER NOT NULL REFERENCES analysis(number),
  usable INTEGER NOT NULL, failed INTEGER NOT NULL, reason TEXT NOT NULL,
  UNIQUE (recording, analysis)) STRICT;
CREATE INDEX result_analysis ON result(analysis, recording);
CREATE TABLE document(
  result INTEGER PRIMARY KEY REFERENCES result(number) ON DELETE CASCADE, text TEXT NOT NULL) STRICT;
CREATE TABLE outcome(
  result INTEGER NOT NULL REFERENCES result(number) ON DELETE CASCADE,
  position INTEGER NOT NULL, name TEXT NOT NULL, value REAL NOT NULL, standard_error REAL, unit TEXT NOT NULL,
  PRIMARY KEY (result, position)) STRICT, WITHOUT ROWID;
CREATE TABLE erasure(file TEXT PRIMARY KEY) STRICT, WITHOUT ROWID;
CREATE TABLE log(
  number INTEGER PRIMARY KEY, time TEXT NOT NULL, role TEXT NOT NULL, action TEXT NOT NULL,
  recording INTEGER, analysis INTEGER, participant INTEGER, digest TEXT NOT NULL, why TEXT NOT NULL,
  hash TEXT NOT NULL) STRICT;
CREATE TRIGGER log_is_never_changed BEFORE UPDATE ON log BEGIN SELECT RAISE(ABORT, 'the log is append-only'); END;
CREATE TRIGGER log_is_never_shortened BEFORE DELETE ON log BEGIN SELECT RAISE(ABORT, 'the log is append-only'); END;
)",
    // the numbers of a result in one row: a summary reads millions of them
    R"(
CREATE TABLE layout(number INTEGER PRIMARY KEY, names TEXT NOT NULL UNIQUE) STRICT;
CREATE TABLE packed(
  result INTEGER PRIMARY KEY REFERENCES result(number) ON DELETE CASCADE,
  layout INTEGER NOT NULL REFERENCES layout(number), numbers BLOB NOT NULL) STRICT;
DROP TABLE outcome;
)",
    // who measured
    R"(
ALTER TABLE recording ADD COLUMN rater TEXT NOT NULL DEFAULT '';
)"};

int pragma_number(SQLite::Database& connection, const char* pragma) {
  return connection.execAndGet(pragma).getInt();
}

std::string sum_of(const Json& json) {
  return sha256_of(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json or_null(const std::optional<std::int64_t>& number) {
  return number ? Json(*number) : Json();
}

/// By which it shows whether a database was written; nothing while changes are in its log alone.
std::optional<system::FileStatus> whole_state(const std::filesystem::path& file) {
  std::filesystem::path log = file;
  log += "-wal";
  if (const auto status = system::status_of(log); status && status->size > 0) return std::nullopt;
  return system::status_of(file);
}

/// A database of these bytes that cannot be written.
std::unique_ptr<Database> in_memory(const std::filesystem::path& folder, std::string bytes) {
  constexpr std::size_t kWriteVersion = 18, kReadVersion = 19;  // 2: with a log of changes, which memory does not have
  if (bytes.size() > kReadVersion) bytes[kWriteVersion] = bytes[kReadVersion] = 1;
  auto database = std::make_unique<Database>(folder, SQLite::OPEN_READWRITE, kInMemory);
  database->read_only = true;
  sqlite3* const connection = database->connection.getHandle();
  auto* const copy = static_cast<unsigned char*>(sqlite3_malloc64(bytes.size()));
  if (copy == nullptr) throw SQLite::Exception("no memory for the database", SQLITE_NOMEM);
  std::ranges::copy(bytes, copy);
  const auto size = static_cast<sqlite3_int64>(bytes.size());
  const int code = sqlite3_deserialize(connection, "main", copy, size, size,
                                       SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_READONLY);
  if (code != SQLITE_OK) throw SQLite::Exception(connection, code);
  return database;
}

}  // namespace

int Database::wait(void* database, int count) {
  Database& self = *static_cast<Database*>(database);
  const auto now = std::chrono::steady_clock::now();
  if (count == 0) self.wait_began_ = now;
  const auto waited = now - self.wait_began_;
  if (waited > kLongestWait) return 0;
  if (waited > kUnnoticedWait && !std::exchange(self.told_, true) && self.waiting) self.waiting();
  std::this_thread::sleep_for(std::chrono::milliseconds(count < 10 ? 1 : 10));
  return 1;
}

Database::Database(const std::filesystem::path& in, int flags, const std::string& name,
                   std::function<void()> on_waiting)
    : folder(in), waiting(std::move(on_waiting)), connection(name == kInMemory ? name : (in / name).string(), flags) {
  sqlite3_busy_handler(connection.getHandle(), &Database::wait, this);
  connection.exec(
      "PRAGMA trusted_schema = OFF;"
      "PRAGMA foreign_keys = ON;"
      "PRAGMA journal_mode = WAL;"
      "PRAGMA synchronous = FULL;"
      "PRAGMA secure_delete = ON;"
      "PRAGMA temp_store = MEMORY;");
}

Result<std::unique_ptr<Database>> Database::snapshot(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kDatabaseName;
  constexpr int kAttempts = 20;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const auto before = whole_state(file);
    std::string bytes;
    MBK_TRY(files::read_pieces(file, [&](std::span<const std::byte> piece) -> Result<void> {
      bytes.append(reinterpret_cast<const char*>(piece.data()), piece.size());
      return {};
    }));
    if (before && before == whole_state(file)) return in_memory(folder, std::move(bytes));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return bad_data("the study is read-only, and another process is changing it or was interrupted while changing it",
                  "try again later, or have someone with write permission run 'mbk study list'", file.string());
}

Error error_of(const SQLite::Exception& exception, const std::filesystem::path& folder) {
  const std::string file = (folder / kDatabaseName).string();
  const std::string said = exception.what();
  switch (exception.getErrorCode()) {
    case SQLITE_FULL:
      return {ErrorKind::data, "the disk is full", "free space; nothing was stored partially", file};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorKind::data, "another process has been writing for half a minute", "try again when it has finished",
              file};
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return {ErrorKind::data, printable("the database is damaged: " + said), "restore the folder from a backup", file};
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      return {ErrorKind::data, printable("the database cannot be opened for writing: " + said),
              "check the permissions of the folder, and the space on the disk", file};
    default:
      return {ErrorKind::data, printable("the database cannot be used: " + said),
              "check the disk; 'mbk study check' says what is sound", file};
  }
}

Result<void> migrate(SQLite::Database& connection, const std::filesystem::path& folder) {
  const std::string file = (folder / kDatabaseName).string();
  const int latest = static_cast<int>(kMigrations.size());
  const auto version = [&] { return pragma_number(connection, "PRAGMA user_version"); };
  if (version() == latest && pragma_number(connection, "PRAGMA application_id") == kApplication) return {};
  if (sqlite3_db_readonly(connection.getHandle(), "main") != 0 && version() < latest && version() > 0) {
    return bad_data("was written by an older mbk, and may only be read",
                    "have someone with write permission run 'mbk study list'", file);
  }
  WriteTransaction alone(connection,
                         sqlite3_db_readonly(connection.getHandle(), "main") != 0 ? "BEGIN" : "BEGIN IMMEDIATE");
  const int found = version();
  const int application = pragma_number(connection, "PRAGMA application_id");
  if (application != kApplication && (application != 0 || found != 0)) {
    return bad_data("the file is the database of another program", "name the folder of a study", file);
  }
  if (found > latest) {
    return bad_data(
        fmt::format("was written by a newer mbk (tables of version {}; this one supports {})", found, latest),
        "use the newer mbk", file);
  }
  for (int i = found; i < latest; ++i) connection.exec(kMigrations.at(static_cast<std::size_t>(i)));
  if (found == 1) {
    if (auto ok = pack_all_outcomes(connection); !ok) return tl::unexpected(ok.error().in(file));
  }
  connection.exec(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};", kApplication, latest));
  alone.commit();
  return {};
}

std::string sha256_of(const std::string& text) {
  return recording::sha256(std::as_bytes(std::span(text)));
}

std::string utc_now() {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

std::string new_salt() {
  std::array<unsigned char, 16> bytes{};
  if (!system::random_bytes(std::as_writable_bytes(std::span(bytes)))) {
    std::random_device device;
    for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(device());
  }
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

std::string hash_of(const LogLine& line, const std::string& before) {
  return sum_of(Json::array({"mbk.study.log/1", line.number, line.time, word_of(line.role), word_of(line.action),
                             or_null(line.recording), or_null(line.analysis), or_null(line.participant), line.digest,
                             line.why, before}));
}

void append_to_log(SQLite::Database& connection, LogLine line) {
  std::string before;
  line.number = 1;
  if (auto last = query(connection, "SELECT number, hash FROM log ORDER BY number DESC LIMIT 1"); last.executeStep()) {
    line.number = number_at(last, 0) + 1;
    before = text_at(last, 1);
  }
  line.time = utc_now();
  line.why = printable(line.why);
  line.hash = hash_of(line, before);
  execute(connection, "INSERT INTO log VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)", line.number, line.time,
          std::string(word_of(line.role)), std::string(word_of(line.action)), line.recording, line.analysis,
          line.participant, line.digest, line.why, line.hash);
}

SaltedRecording recording_at(const SQLite::Statement& row) {
  SaltedRecording one;
  StoredRecording& r = one.recording;
  r.number = number_at(row, 0);
  r.sha256 = text_at(row, 1);
  r.part = number_at(row, 2);
  r.extension = text_at(row, 3);
  r.bytes = number_at(row, 4);
  r.participant = number_at(row, 5);
  r.session = number_at(row, 6);
  r.trial = number_at(row, 7);
  r.condition = text_at(row, 8);
  r.duration_s = row.getColumn(9).getDouble();
  r.added = text_at(row, 10);
  r.origin_sha256 = text_at(row, 11);
  if (!row.getColumn(12).isNull()) r.excluded_why = text_at(row, 12);
  one.salt = text_at(row, 13);
  r.rater = text_at(row, 14);
  return one;
}

std::string digest_of(const SaltedRecording& salted) {
  const StoredRecording& r = salted.recording;
  Json facts = Json::array({salted.salt, r.number, r.sha256, r.part, r.extension, r.bytes, r.participant, r.session,
                            r.trial, r.condition, r.duration_s, r.added, r.origin_sha256});
  if (!r.rater.empty()) facts.push_back(r.rater);  // the digests of recordings without a rater are those of before
  return sum_of(facts);
}

std::string digest_of(const std::string& salt, const std::string& options_sha256, const std::string& version,
                      const UnitResult& result) {
  return sum_of(Json::array({salt, options_sha256, version, result.usable, result.reason, result.document}));
}

}  // namespace mbk::store
