#include "mbk/study/store/store.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <atomic>
#include <cerrno>
#include <limits>
#include <map>
#include <system_error>

#include "mbk/base/core/printable.h"
#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/study/store/store_database.h"
#include "mbk/study/store/store_files.h"
#include "mbk/study/store/trial_names.h"

namespace mbk::store {
namespace {

namespace fs = std::filesystem;

std::string temporary_name() {
  static std::atomic<unsigned> count = 0;
  return fmt::format(".{}.{}.{}.part", system::process_id(), count++, new_salt().substr(0, 8));
}

Result<void> check_why(const std::string& why) {
  constexpr std::size_t kLongest = 2000;  // as the pages of a session take it
  if (why.empty()) return bad_usage("the reason is missing", "give one; it stays in the log, so name nobody");
  if (why.size() > kLongest) return bad_usage("the reason is longer than 2000 bytes", "shorten it");
  return {};
}

/// In a transaction that is open.
void exclude_one(SQLite::Database& connection, std::int64_t number, const std::string& why, Role role) {
  execute(connection, "UPDATE recording SET excluded_why = ? WHERE number = ?", printable(why), number);
  LogLine line{.role = role, .action = LoggedAction::exclude};
  line.recording = number;
  line.why = why;
  append_to_log(connection, line);
}

Result<void> check_facts(const TrialFacts& facts) {
  constexpr std::int64_t kLargest = 999999999;
  constexpr std::size_t kLongest = 80;
  const auto within = [&](std::int64_t number) { return number >= 1 && number <= kLargest; };
  if (!within(facts.participant))
    return bad_usage("the participant is not a whole number from 1", "pass --participant N");
  if (!within(facts.session)) return bad_usage("the session is not a whole number from 1", "pass --session N");
  if (facts.trial && !within(*facts.trial))
    return bad_usage("the trial is not a whole number from 1", "pass --trial N");
  if (facts.condition.size() > kLongest || printable(facts.condition) != facts.condition) {
    return bad_usage("the condition is not one line of at most 80 bytes",
                     "give it a short name, as in --condition relaxed");
  }
  if (!facts.rater.empty() && rater_code(facts.rater) != facts.rater) {
    return bad_usage("the rater is neither a number nor a short code", std::string(kRaterAdvice));
  }
  return {};
}

Error no_recording(std::int64_t number) {
  return {ErrorKind::usage, fmt::format("there is no recording {}", number), "'mbk study list' shows the existing ones",
          ""};
}

}  // namespace

IncomingFile::IncomingFile() = default;
IncomingFile::IncomingFile(IncomingFile&& other) noexcept
    : lock_(std::move(other.lock_)),
      path_(std::exchange(other.path_, {})),
      sha256_(std::move(other.sha256_)),
      extension_(std::move(other.extension_)),
      bytes_(other.bytes_) {}

IncomingFile::~IncomingFile() {
  if (!path_.empty()) system::remove_name(path_);
}

Store::Store(std::unique_ptr<Database> database) : database_(std::move(database)) {}
Store::Store(Store&&) noexcept = default;
Store::~Store() = default;

const fs::path& Store::folder() const {
  return database_->folder;
}

Result<void> Store::create(const fs::path& folder, const StudyFacts& facts, Role role) {
  const auto there = [&] {
    return fail(ErrorKind::usage, "the folder already contains a study", "use it, or choose another folder",
                folder.string());
  };
  std::error_code code;
  if (fs::exists(folder / kDatabaseName, code)) return there();
  MBK_TRY(files::make_folder(folder));
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    const bool ours = name == kRecordingsName || name == "lock" || name.find(".part") != std::string::npos;
    if (!ours) {
      return fail(ErrorKind::usage, fmt::format("the folder is not empty: it contains {}", name),
                  "name a new folder for the study", folder.string());
    }
  }
  fs::permissions(folder, fs::perms::owner_all, code);
  if (code)
    return bad_data("its permissions cannot be set: " + code.message(), "choose another folder", folder.string());
  MBK_TRY(files::make_folder(folder / kRecordingsName));
  return guarded(folder, [&]() -> Result<void> {
    // Whole before it has its name: who finds it finds a study.
    const std::string temporary = temporary_name();
    const fs::path path = folder / temporary;
    if (!system::create_new(path)) {
      return bad_data("cannot be written: " + std::generic_category().message(errno), "check the folder",
                      path.string());
    }
    {
      Database database(folder, SQLite::OPEN_READWRITE, temporary.c_str());
      SQLite::Database& connection = database.connection;
      MBK_TRY(migrate(connection, folder));
      WriteTransaction transaction(connection);
      execute(connection, "INSERT INTO fact VALUES ('title', ?), ('options', ?)", facts.title, facts.options);
      LogLine line{.role = role, .action = LoggedAction::init};
      line.digest = sha256_of(facts.options);
      append_to_log(connection, line);
      transaction.commit();
      connection.exec("PRAGMA wal_checkpoint(TRUNCATE)");
    }
    const int error = system::link(path, folder / kDatabaseName);
    system::remove_name(path);
    if (error != 0) {
      if (error == EEXIST) return there();
      return bad_data("cannot be written: " + std::generic_category().message(error), "choose a folder on a local disk",
                      folder.string());
    }
    return files::flush_folder(folder);
  });
}

Result<Store> Store::open(const fs::path& folder, std::function<void()> waiting) {
  std::error_code code;
  if (!fs::exists(folder / kDatabaseName, code)) {
    return fail(ErrorKind::usage, "the folder contains no study", "create one with 'mbk study init FOLDER'",
                folder.string());
  }
  return guarded(folder, [&]() -> Result<Store> {
    const bool writable = system::may_write(folder / kDatabaseName) && system::may_write(folder);
    std::unique_ptr<Database> database;
    if (writable) {
      database = std::make_unique<Database>(folder, SQLite::OPEN_READWRITE, kDatabaseName, std::move(waiting));
    } else {
      database = MBK_TRY(Database::snapshot(folder));
      database->waiting = std::move(waiting);
    }
    MBK_TRY(migrate(database->connection, folder));
    if (writable && is_erasing(*database)) {  // a process was ended while it forgot someone
      MBK_TRY(FolderLock::take(folder, FolderLock::Kind::alone, database->waiting));
      MBK_TRY(finish_erasing(*database));
    }
    return Store(std::move(database));
  });
}

Result<StudyFacts> Store::facts() const {
  return guarded(folder(), [&]() -> Result<StudyFacts> {
    StudyFacts facts;
    SQLite::Statement rows(database_->connection, "SELECT name, value FROM fact");
    while (rows.executeStep()) {
      if (text_at(rows, 0) == "title") facts.title = text_at(rows, 1);
      if (text_at(rows, 0) == "options") facts.options = text_at(rows, 1);
    }
    return facts;
  });
}

Result<void> Store::set_options(const std::string& options, Role role) {
  return guarded(folder(), [&]() -> Result<void> {
    SQLite::Database& connection = database_->connection;
    WriteTransaction transaction(connection);
    execute(connection, "UPDATE fact SET value = ? WHERE name = 'options'", options);
    LogLine line{.role = role, .action = LoggedAction::defaults};
    line.digest = sha256_of(options);
    append_to_log(connection, line);
    transaction.commit();
    return {};
  });
}

Result<IncomingFile> Store::bring_in(const fs::path& file) const {
  return bring_in(file, kept_extension(file));
}

Result<IncomingFile> Store::bring_in(const fs::path& file, const std::string& extension) const {
  IncomingFile incoming;
  incoming.lock_ = MBK_TRY(FolderLock::take(folder(), FolderLock::Kind::shared, database_->waiting));
  const fs::path to = folder() / kRecordingsName / temporary_name();
  auto copied = MBK_TRY(files::copy_hashed(file, to));
  incoming.path_ = to;
  incoming.sha256_ = std::move(copied.sha256);
  incoming.bytes_ = copied.bytes;
  incoming.extension_ = extension;
  return incoming;
}

Result<std::vector<StoredRecording>> Store::recordings_of(const std::string& sha256) const {
  return guarded(folder(), [&]() -> Result<std::vector<StoredRecording>> {
    std::vector<StoredRecording> found;
    auto rows = query(database_->connection,
                      fmt::format("SELECT {} FROM recording WHERE sha256 = ?1 OR origin_sha256 = ?1 ORDER BY number",
                                  kRecordingColumns)
                          .c_str(),
                      sha256);
    while (rows.executeStep()) found.push_back(recording_at(rows).recording);
    return found;
  });
}

Result<std::vector<AddedRecording>> Store::add(IncomingFile incoming, std::span<const NewRecording> recordings,
                                               const std::string& origin_sha256, Role role) {
  for (const NewRecording& one : recordings) {
    MBK_TRY(check_facts(one.trial));
    if (one.excluded_why.empty()) continue;
    MBK_TRY(check_why(one.excluded_why));
  }
  // The file has its name, and the disk has that, before any row speaks of it.
  const fs::path to = folder() / stored_name(incoming.sha256_, incoming.extension_);
  MBK_TRY(files::make_folder(to.parent_path()));
  return guarded(folder(), [&]() -> Result<std::vector<AddedRecording>> {
    SQLite::Database& connection = database_->connection;
    std::vector<AddedRecording> added;
    WriteTransaction transaction(connection);
    const std::string by_key = fmt::format("SELECT {} FROM recording WHERE sha256 = ? AND part = ?", kRecordingColumns);
    bool any_new = false;
    for (const NewRecording& one : recordings) {
      auto row = query(connection, by_key.c_str(), incoming.sha256_, one.part);
      if (row.executeStep()) {
        const StoredRecording there = recording_at(row).recording;
        const TrialFacts& facts = one.trial;
        if (there.participant != facts.participant || there.session != facts.session ||
            there.condition != facts.condition || there.rater != facts.rater ||
            (facts.trial && there.trial != *facts.trial)) {
          return bad_data(
              fmt::format(
                  "the file is already stored as recording {}: participant {}, session {}, condition '{}', trial {}{}",
                  there.number, there.participant, there.session, there.condition, there.trial,
                  there.rater == facts.rater ? ""
                  : there.rater.empty()      ? ", without a rater"
                                             : ", rater " + there.rater),
              "a recording can belong to only one participant: check the number and the file");
        }
        added.push_back({there, true});
        continue;
      }
      any_new = true;
      SaltedRecording salted;
      StoredRecording& r = salted.recording;
      r = {.number = 0,
           .sha256 = incoming.sha256_,
           .part = one.part,
           .extension = incoming.extension_,
           .bytes = incoming.bytes_,
           .participant = one.trial.participant,
           .session = one.trial.session,
           .trial = one.trial.trial.value_or(0),
           .condition = one.trial.condition,
           .duration_s = one.duration_s,
           .added = utc_now(),
           .origin_sha256 = origin_sha256,
           .excluded_why = std::nullopt,
           .rater = one.trial.rater};
      if (!one.trial.trial) {
        auto next = query(connection,
                          "SELECT coalesce(max(trial), 0) + 1 FROM recording "
                          "WHERE participant = ? AND session = ? AND condition = ? AND rater = ?",
                          r.participant, r.session, r.condition, r.rater);
        next.executeStep();
        r.trial = number_at(next, 0);
      }
      salted.salt = new_salt();
      execute(connection,
              "INSERT INTO recording(sha256, part, extension, bytes, participant, session, trial, condition, "
              "duration_s, added, origin_sha256, salt, rater) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
              r.sha256, r.part, r.extension, r.bytes, r.participant, r.session, r.trial, r.condition, r.duration_s,
              r.added, r.origin_sha256, salted.salt, r.rater);
      r.number = connection.getLastInsertRowid();
      LogLine line{.role = role, .action = LoggedAction::add};
      line.recording = r.number;
      line.digest = digest_of(salted);
      append_to_log(connection, line);
      if (!one.excluded_why.empty()) {
        exclude_one(connection, r.number, one.excluded_why, role);
        r.excluded_why = printable(one.excluded_why);
      }
      added.push_back({r, false});
    }
    if (!any_new) return added;
    MBK_TRY(files::rename_on_disk(incoming.path_, to));
    incoming.path_.clear();
    transaction.commit();
    return added;
  });
}

Result<std::vector<StoredRecording>> Store::recordings() const {
  return guarded(folder(), [&]() -> Result<std::vector<StoredRecording>> {
    std::vector<StoredRecording> all;
    auto rows = query(database_->connection,
                      fmt::format("SELECT {} FROM recording ORDER BY number", kRecordingColumns).c_str());
    while (rows.executeStep()) all.push_back(recording_at(rows).recording);
    return all;
  });
}

Result<StoredRecording> Store::recording(std::int64_t number) const {
  return guarded(folder(), [&]() -> Result<StoredRecording> {
    auto row = query(database_->connection,
                     fmt::format("SELECT {} FROM recording WHERE number = ?", kRecordingColumns).c_str(), number);
    if (!row.executeStep()) return tl::unexpected(no_recording(number));
    return recording_at(row).recording;
  });
}

Result<void> Store::exclude(std::int64_t number, const std::string& why, Role role) {
  MBK_TRY(check_why(why));
  return guarded(folder(), [&]() -> Result<void> {
    SQLite::Database& connection = database_->connection;
    WriteTransaction transaction(connection);
    const auto there = recording(number);
    if (!there) return tl::unexpected(there.error());
    if (there->excluded_why) {
      return bad_usage(fmt::format("recording {} is excluded already: {}", number, *there->excluded_why),
                       "pass --undo to include it again");
    }
    exclude_one(connection, number, why, role);
    transaction.commit();
    return {};
  });
}

Result<void> Store::include(std::int64_t number, const std::string& why, Role role) {
  if (!why.empty()) {
    MBK_TRY(check_why(why));
  }
  return guarded(folder(), [&]() -> Result<void> {
    SQLite::Database& connection = database_->connection;
    WriteTransaction transaction(connection);
    const auto there = MBK_TRY(recording(number));
    if (!there.excluded_why)
      return bad_usage(fmt::format("recording {} is not excluded", number), "omit --undo to exclude it");
    execute(connection, "UPDATE recording SET excluded_why = NULL WHERE number = ?", number);
    LogLine line{.role = role, .action = LoggedAction::include};
    line.recording = number;
    line.why = why;
    append_to_log(connection, line);
    transaction.commit();
    return {};
  });
}

std::optional<fs::path> find_study(const fs::path& from) {
  std::error_code code;
  fs::path folder = fs::absolute(from, code).lexically_normal();
  while (!code) {
    if (fs::is_regular_file(folder / kDatabaseName, code)) return folder;
    code.clear();
    if (!folder.has_relative_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

}  // namespace mbk::store
