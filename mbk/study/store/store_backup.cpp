#include <SQLiteCpp/Backup.h>
#include <fmt/format.h>

#include <cerrno>
#include <set>
#include <system_error>

#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/study/store/store.h"
#include "mbk/study/store/store_database.h"
#include "mbk/study/store/store_files.h"

namespace mbk::store {
namespace {

namespace fs = std::filesystem;

/// A folder that goes away with all that is in it unless it was renamed.
struct TemporaryFolder {
  fs::path path;
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
};

Result<void> copy_database(Database& from, const fs::path& to) {
  if (!system::create_new(to / kDatabaseName)) {
    return bad_data("cannot be written: " + std::generic_category().message(errno), "check the folder", to.string());
  }
  SQLite::Database copy((to / kDatabaseName).string(), SQLite::OPEN_READWRITE);
  copy.exec("PRAGMA synchronous = FULL");
  SQLite::Backup backup(copy, from.connection);
  backup.executeStep(-1);
  return {};
}

Result<void> copy_recording(const fs::path& from, const fs::path& to, bool link) {
  if (link && system::link(from, to) == 0) return {};
  MBK_TRY(files::copy_hashed(from, to));
  return {};
}

}  // namespace

Result<CheckReport> Store::backup(const fs::path& to, bool link) {
  std::error_code code;
  if (fs::exists(to, code)) {
    return fail(ErrorKind::usage, "already exists", "name a new folder", to.string());
  }
  auto lock =
      FolderLock::take(folder(), FolderLock::Kind::shared, database_->waiting);  // nothing is forgotten meanwhile
  if (!lock) return tl::unexpected(lock.error());
  return guarded(folder(), [&]() -> Result<CheckReport> {
    const fs::path parent = to.has_parent_path() ? to.parent_path() : fs::path(".");
    TemporaryFolder temporary{parent / fmt::format(".{}.{}.part", to.filename().string(), system::process_id())};
    fs::remove_all(temporary.path, code);
    MBK_TRY(files::make_folder(temporary.path));
    MBK_TRY(files::make_folder(temporary.path / kRecordingsName));
    MBK_TRY(copy_database(*database_, temporary.path));
    CheckReport report;
    {
      auto copy = MBK_TRY(Store::open(temporary.path));
      const auto recordings = MBK_TRY(copy.recordings());
      std::set<std::string> names;
      for (const StoredRecording& one : recordings) names.insert(stored_name(one.sha256, one.extension));
      for (const std::string& name : names) {
        const fs::path target = temporary.path / name;
        MBK_TRY(files::make_folder(target.parent_path()));
        MBK_TRY(copy_recording(folder() / name, target, link));
      }
      for (const std::string& name : names) {
        MBK_TRY(files::flush_folder((temporary.path / name).parent_path()));
      }
      report = MBK_TRY(copy.check(false, {}));
    }
    if (!report.problems.empty()) {
      return bad_data("the copy is faulty: " + report.problems.front(),
                      "no backup was made; check the study with 'mbk study check'", folder().string());
    }
    MBK_TRY(files::rename_on_disk(temporary.path, parent / to.filename()));
    temporary.path.clear();
    return report;
  });
}

}  // namespace mbk::store
