#include "mbk/study/workflow/export_bids.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <map>
#include <utility>

#include "mbk/base/system/files.h"
#include "mbk/files/recording/write_bids.h"
#include "mbk/study/store/identifying.h"
#include "mbk/study/store/store_files.h"
#include "mbk/study/store/trial_names.h"
#include "mbk/study/workflow/measuring.h"

namespace mbk::workflow {
namespace {

namespace fs = std::filesystem;

/// A label for each condition: its letters and digits, and a number where others have the same ones.
std::map<std::string, std::string> labels_of(const store::StudyList& list) {
  std::map<std::string, std::string> labels;
  std::set<std::string> taken;
  for (const store::ListedRecording& one : list.recordings) {
    const std::string& condition = one.recording.condition;
    if (labels.contains(condition)) continue;
    const std::string label = store::bids_label(condition);
    std::string unique = label;
    for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}x{}", label, k);
    labels[condition] = unique;
  }
  return labels;
}

/// A folder that is not there yet: it is filled under another name, and has its own when it is whole.
class NewFolder {
 public:
  static Result<NewFolder> of(const fs::path& folder) {
    std::error_code code;
    const fs::path path = fs::absolute(folder, code).lexically_normal();
    NewFolder made;
    made.target_ = path.has_filename() ? path : path.parent_path();
    if (fs::exists(fs::symlink_status(made.target_, code)) &&
        !(fs::is_directory(made.target_, code) && fs::is_empty(made.target_, code))) {
      return fail(ErrorKind::usage, "already exists", "name a new folder", folder.string());
    }
    made.path_ = system::make_temporary_folder(made.target_.string() + ".part");
    if (made.path_.empty()) {
      return bad_data("cannot be made: " + std::generic_category().message(errno), "check the folder above it",
                      folder.string());
    }
    return made;
  }
  NewFolder(NewFolder&& other) noexcept
      : target_(std::move(other.target_)), path_(std::exchange(other.path_, fs::path())) {}
  NewFolder& operator=(NewFolder&&) = delete;
  ~NewFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }

  [[nodiscard]] const fs::path& path() const { return path_; }

  Result<void> keep() {
    std::error_code code;
    fs::rename(path_, target_, code);
    if (code) return bad_data("cannot be made: " + code.message(), "name another folder", target_.string());
    path_.clear();
    return {};
  }

 private:
  NewFolder() = default;
  fs::path target_, path_;
};

Result<Recording> read_unchanged(const store::Store& study, const Measuring& measuring,
                                 const store::StoredRecording& r) {
  const fs::path file = study.folder() / store::stored_name(r.sha256, r.extension);
  auto recording = read_stored(measuring, file, r.part, Reading::whole);
  if (!recording) return recording;
  if (recording->sources.size() != 1 || recording->sources.front().sha256 != r.sha256) {
    return bad_data("its content differs from what was added", "restore it from a backup; 'mbk study check' names all",
                    file.string());
  }
  return recording;
}

/// What the study says of a recording, in place of what it said itself.
void tell(Recording& recording, const store::StoredRecording& r) {
  for (const std::string& key : store::identifying_entries(recording.metadata)) recording.metadata.erase(key);
  recording.metadata["participant"] = fmt::format("{}", r.participant);
  recording.metadata["session"] = fmt::format("{}", r.session);
  recording.metadata["trial"] = fmt::format("{}", r.trial);
  recording.metadata.erase("condition");
  if (!r.condition.empty()) recording.metadata["condition"] = r.condition;
  if (!r.rater.empty()) recording.metadata["rater"] = r.rater;
}

}  // namespace

Result<ExportedBids> export_bids(const store::Store& study, const store::StudyList& list, const fs::path& folder) {
  const auto defaults = MBK_TRY(default_options(study));
  const auto measuring = MBK_TRY(measuring_of(defaults));
  const auto counts = [](const store::ListedRecording& one) { return !one.recording.excluded_why; };
  if (std::ranges::none_of(list.recordings, counts)) {
    return bad_usage("there is nothing to export: every recording is excluded, or there is none",
                     "add recordings with 'mbk study add'; 'mbk study list' shows them");
  }
  auto made = MBK_TRY(NewFolder::of(folder));
  const auto labels = labels_of(list);
  ExportedBids exported;
  for (const store::ListedRecording& one : list.recordings) {
    const store::StoredRecording& r = one.recording;
    if (r.excluded_why) {
      exported.excluded.push_back(r.number);
      continue;
    }
    auto recording = read_unchanged(study, *measuring, r);
    if (!recording) {
      exported.failed.push_back(recording.error());
      continue;
    }
    tell(*recording, r);
    const std::string name =
        fmt::format("sub-{:02}_ses-{}_task-{}_{}run-{}", r.participant, r.session, labels.at(r.condition),
                    r.rater.empty() ? "" : fmt::format("acq-rater{}_", r.rater), r.trial);
    MBK_TRY(recording::write_bids(*recording, made.path(), name, false, Readers::owner, list.facts.title));
    for (std::string& what : recording::lost_in_bids(*recording)) exported.lost.insert(std::move(what));
    ++exported.written;
  }
  MBK_TRY(made.keep());
  return exported;
}

}  // namespace mbk::workflow
