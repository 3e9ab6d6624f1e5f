// Results of a study: which are missing, storing them, reading them.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "mbk/study/store/store.h"
#include "mbk/study/store/store_database.h"
#include "mbk/study/store/store_files.h"

namespace mbk::store {
namespace {

Analysis analysis_at(const SQLite::Statement& row) {
  return {number_at(row, 0), text_at(row, 1), text_at(row, 2), text_at(row, 3)};
}

StoredResult result_at(const SQLite::Statement& row) {
  return {number_at(row, 0),      number_at(row, 1),      number_at(row, 2),
          number_at(row, 3) != 0, number_at(row, 4) != 0, text_at(row, 5)};
}

std::vector<Unit> units_at(SQLite::Statement rows) {
  std::vector<Unit> units;
  while (rows.executeStep()) {
    units.push_back({text_at(rows, 0), number_at(rows, 1), stored_name(text_at(rows, 0), text_at(rows, 2))});
  }
  return units;
}

/// The analysis of that key, made where it is not there.
std::int64_t analysis_of(SQLite::Database& connection, const std::string& options, const std::string& version) {
  const std::string sum = sha256_of(options);
  execute(connection, "INSERT OR IGNORE INTO analysis(options_sha256, options, version) VALUES (?, ?, ?)", sum, options,
          version);
  auto row = query(connection, "SELECT number FROM analysis WHERE options_sha256 = ? AND version = ?", sum, version);
  row.executeStep();
  return number_at(row, 0);
}

/// Stores one result.   @returns  whether it is new
bool save_one(SQLite::Database& connection, std::int64_t analysis, const std::string& options_sha256,
              const std::string& version, const Unit& unit, const UnitResult& result,
              const std::vector<Outcome>& outcomes, Role role) {
  auto row =
      query(connection, "SELECT number, salt FROM recording WHERE sha256 = ? AND part = ?", unit.sha256, unit.part);
  if (!row.executeStep()) return false;  // forgotten since it was read
  const std::int64_t recording = number_at(row, 0);
  const std::string salt = text_at(row, 1);
  const bool failed = result.document.empty();
  if (!failed) {
    execute(connection, "DELETE FROM result WHERE recording = ? AND analysis = ? AND failed = 1", recording, analysis);
  }
  const int stored = execute(connection,
                             "INSERT OR IGNORE INTO result(recording, analysis, usable, failed, reason) "
                             "VALUES (?, ?, ?, ?, ?)",
                             recording, analysis, std::int64_t{result.usable}, std::int64_t{failed}, result.reason);
  if (stored == 0) return false;
  const std::int64_t number = connection.getLastInsertRowid();
  if (!failed) execute(connection, "INSERT INTO document VALUES (?, ?)", number, result.document);
  if (!outcomes.empty()) pack_outcomes(connection, number, outcomes);
  LogLine line{.role = role, .action = LoggedAction::measure};
  line.recording = recording;
  line.analysis = analysis;
  line.digest = digest_of(salt, options_sha256, version, result);
  append_to_log(connection, line);
  return true;
}

}  // namespace

Result<std::vector<Analysis>> Store::analyses() const {
  return guarded(folder(), [&]() -> Result<std::vector<Analysis>> {
    std::vector<Analysis> all;
    SQLite::Statement rows(database_->connection,
                           "SELECT number, options_sha256, options, version FROM analysis ORDER BY number");
    while (rows.executeStep()) all.push_back(analysis_at(rows));
    return all;
  });
}

Result<std::optional<Analysis>> Store::latest_analysis() const {
  return guarded(folder(), [&]() -> Result<std::optional<Analysis>> {
    SQLite::Statement row(database_->connection,
                          "SELECT number, options_sha256, options, version FROM analysis WHERE number = "
                          "(SELECT analysis FROM result ORDER BY number DESC LIMIT 1)");
    if (!row.executeStep()) return std::optional<Analysis>();
    return std::optional(analysis_at(row));
  });
}

Result<std::vector<Unit>> Store::pending(const std::string& options, const std::string& version,
                                         bool again_failed) const {
  return guarded(folder(), [&]() -> Result<std::vector<Unit>> {
    return units_at(query(database_->connection,
                          "SELECT sha256, part, extension FROM recording WHERE excluded_why IS NULL AND NOT EXISTS "
                          "(SELECT 1 FROM result JOIN analysis ON analysis.number = result.analysis "
                          " WHERE result.recording = recording.number AND options_sha256 = ? AND version = ? "
                          " AND (failed = 0 OR failed != ?)) ORDER BY sha256, part",
                          sha256_of(options), version, std::int64_t{again_failed}));
  });
}

Result<std::vector<Unit>> Store::measured(std::int64_t analysis) const {
  return guarded(folder(), [&]() -> Result<std::vector<Unit>> {
    return units_at(query(database_->connection,
                          "SELECT sha256, part, extension FROM recording JOIN result ON recording.number = recording "
                          "WHERE analysis = ? ORDER BY sha256, part",
                          analysis));
  });
}

Result<int> Store::save(const std::string& options, const std::string& version, std::span<const Unit> units,
                        std::span<const UnitResult> results, Role role) {
  std::vector<std::vector<Outcome>> outcomes;
  for (const UnitResult& result : results) {
    if (result.document.empty()) {
      outcomes.emplace_back();
      continue;
    }
    auto found = MBK_TRY(outcomes_of(result.document));
    outcomes.push_back(std::move(found));
  }
  return guarded(folder(), [&]() -> Result<int> {
    SQLite::Database& connection = database_->connection;
    WriteTransaction transaction(connection);
    const std::int64_t analysis = analysis_of(connection, options, version);
    const std::string sum = sha256_of(options);
    int count = 0;
    for (std::size_t k = 0; k < units.size(); ++k) {
      if (save_one(connection, analysis, sum, version, units[k], results[k], outcomes[k], role)) ++count;
    }
    transaction.commit();
    return count;
  });
}

Result<std::vector<StoredResult>> Store::results(std::int64_t analysis) const {
  return guarded(folder(), [&]() -> Result<std::vector<StoredResult>> {
    std::vector<StoredResult> all;
    auto rows = query(database_->connection,
                      "SELECT number, recording, analysis, usable, failed, reason FROM result WHERE analysis = ? "
                      "ORDER BY recording",
                      analysis);
    while (rows.executeStep()) all.push_back(result_at(rows));
    return all;
  });
}

Result<std::vector<StoredResult>> Store::results_of(std::int64_t recording) const {
  return guarded(folder(), [&]() -> Result<std::vector<StoredResult>> {
    std::vector<StoredResult> all;
    auto rows = query(database_->connection,
                      "SELECT number, recording, analysis, usable, failed, reason FROM result WHERE recording = ? "
                      "ORDER BY analysis",
                      recording);
    while (rows.executeStep()) all.push_back(result_at(rows));
    return all;
  });
}

Result<std::vector<Outcome>> Store::outcomes(std::int64_t result) const {
  return guarded(folder(),
                 [&]() -> Result<std::vector<Outcome>> { return unpacked_outcomes(database_->connection, result); });
}

Result<std::string> Store::document(std::int64_t result) const {
  return guarded(folder(), [&]() -> Result<std::string> {
    auto row = query(database_->connection, "SELECT text FROM document WHERE result = ?", result);
    return row.executeStep() ? text_at(row, 0) : std::string();
  });
}

Result<std::string> Store::document(const Unit& unit, std::int64_t analysis) const {
  return guarded(folder(), [&]() -> Result<std::string> {
    auto row = query(database_->connection,
                     "SELECT text FROM document JOIN result ON document.result = result.number "
                     "JOIN recording ON recording.number = result.recording "
                     "WHERE sha256 = ? AND part = ? AND analysis = ?",
                     unit.sha256, unit.part, analysis);
    return row.executeStep() ? text_at(row, 0) : std::string();
  });
}

}  // namespace mbk::store
