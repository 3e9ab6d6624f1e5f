#include "mbk/study/workflow/add_recordings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "mbk/experiment/protocol/personal_data.h"
#include "mbk/files/bids/read_run.h"
#include "mbk/files/c3d/c3d.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/kinarm/exam_parameters.h"
#include "mbk/files/recording/formats.h"
#include "mbk/files/recording/write.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/present/request/open_recordings.h"
#include "mbk/study/store/identifying.h"

namespace mbk::workflow {
namespace {

using store::AddedRecording;
using store::KnownFacts;
using Added = Result<std::vector<AddedRecording>>;

bool alike(const KnownFacts& one, const KnownFacts& other) {
  return one.participant == other.participant && one.session == other.session && one.condition == other.condition &&
         one.trial == other.trial && one.rater == other.rater;
}

}  // namespace

/// Adding one file.
class Adder::File {
 public:
  File(store::Store& study, const Measuring& measuring, const AddOptions& options)
      : study_(study), measuring_(measuring), options_(options) {}

  /// @param facts  whose trial it is, as far as that was said
  Added add(const std::filesystem::path& file, const KnownFacts& facts) {
    if (recording::may_be_bids(file)) return add_of_bids(file, facts);
    auto incoming = MBK_TRY(study_.bring_in(file));
    auto added = add(incoming, facts);
    if (!added) return tl::unexpected(named(added.error(), incoming.path(), file));
    return added;
  }

 private:
  /// The error speaks of the file that was named, not of its copy.
  static Error named(Error error, const std::filesystem::path& copy, const std::filesystem::path& file) {
    const std::size_t at = error.where.find(copy.string());
    if (at == std::string::npos) return error.in(file.string());
    error.where.replace(at, copy.string().size(), file.string());
    return error;
  }

  Added add(store::IncomingFile& incoming, const KnownFacts& facts) {
    request::ReadRequest reading = request::reading_for(measuring_.request.reading, measuring_.options);
    reading.files = {incoming.path()};
    const auto reader = MBK_TRY(request::open_recordings(reading, measuring_.request.sensor));
    if (facts.trial && reader.count() > 1) {
      return bad_usage(fmt::format("the file holds {} trials", reader.count()),
                       "omit --trial: trials are numbered automatically");
    }
    if (auto there = find_stripped(incoming, reader, facts); !there || !there->empty()) return there;
    std::vector<store::NewRecording> recordings;
    for (int k = 0; k < reader.count(); ++k) {
      auto recording = MBK_TRY(reader.read(k));
      const std::vector<std::string> unseen = unseen_entries(incoming.path(), recording);
      auto trial = MBK_TRY(check(recording, facts, unseen));
      if (!unseen.empty() || !store::identifying_entries(recording.metadata).empty()) {
        return add_stripped(incoming, reader, facts, unseen);
      }
      recordings.push_back(to_store(reader.count() > 1 ? k + 1 : 0, trial, recording));
    }
    const std::string sha256 = incoming.sha256();
    return study_.add(std::move(incoming), recordings, sha256, options_.role);
  }

  /// Recordings excluded by the operator are excluded in the study too; excluded windows stay in the recording and are
  /// omitted when measuring. Both are reported.
  store::NewRecording to_store(std::int64_t part, const store::TrialFacts& trial, const Recording& recording) const {
    const std::string exclusions = preprocess::exclusions_text(recording);
    if (const auto warning = protocol::personal_warning("the reason of an exclusion", exclusions, false);
        !warning.empty()) {
      options_.warn(warning);
    }
    const auto windows = preprocess::excluded_windows(recording);
    if (!windows) {
      options_.warn(windows.error().line());
    } else if (!windows->empty()) {
      options_.warn("the operator excluded windows, which are omitted when measuring in default mode: " +
                    preprocess::excluded_windows_text(*windows));
    }
    return {part, trial, duration(recording), preprocess::why_excluded(recording)};
  }

  static double duration(const Recording& recording) {
    return recording.samples() > 0 ? recording.time[recording.samples() - 1] - recording.time[0] : 0.0;
  }

  /// What a file holds that its reader does not show, and that may say who the person is.
  static std::vector<std::string> unseen_entries(const std::filesystem::path& file, const Recording& recording) {
    const std::string format = recording.sources.empty() ? "" : recording.sources.front().format;
    if (format.starts_with("KINARM")) return {"the exam's entries on the person, and its name"};
    if (format != "C3D") return {};
    const auto bytes = recording::read_file(file);
    if (!bytes) return {};
    const auto parameters = recording::decode_c3d_parameters(bytes->bytes());
    return parameters ? recording::ExamParameters::of(*parameters).personal_texts() : std::vector<std::string>();
  }

  Result<store::TrialFacts> check(const Recording& recording, const KnownFacts& facts,
                                  const std::vector<std::string>& unseen) const {
    MBK_TRY(preprocess::check_consent(recording));
    auto identifying = store::identifying_entries(recording.metadata);
    identifying.insert(identifying.end(), unseen.begin(), unseen.end());
    if (!identifying.empty() && !options_.strip) {
      return bad_data(fmt::format("its metadata may identify a person: {}", fmt::join(identifying, ", ")),
                      "pass --strip to store a copy without these entries");
    }
    return facts.or_else(store::facts_of(recording.metadata)).complete();
  }

  /// What a file became when it was added before with --strip.
  Added find_stripped(const store::IncomingFile& incoming, const measurement::RecordingReader& reader,
                      const KnownFacts& facts) {
    const auto there = MBK_TRY(study_.recordings_of(incoming.sha256()));
    std::vector<AddedRecording> found;
    for (const store::StoredRecording& one : there) {
      if (one.sha256 == one.origin_sha256) continue;
      if (facts.participant && *facts.participant != one.participant) {
        return bad_data(
            fmt::format("the file is already stored as recording {} of participant {}", one.number, one.participant),
            "a recording can belong to only one participant: check the number and the file");
      }
      found.push_back({one, true});
    }
    if (std::ssize(found) < reader.count()) found.clear();
    return found;
  }

  /// Each trial as a recording of its own, in HDF5, without what may identify a person.
  Added add_stripped(const store::IncomingFile& incoming, const measurement::RecordingReader& reader,
                     const KnownFacts& facts, const std::vector<std::string>& unseen) {
    std::vector<AddedRecording> all;
    for (int k = 0; k < reader.count(); ++k) {
      auto recording = MBK_TRY(reader.read(k));
      const auto trial = MBK_TRY(check(recording, facts, unseen));
      auto added = MBK_TRY(add_copy(incoming, std::move(recording), trial, unseen));
      all.insert(all.end(), added.begin(), added.end());
    }
    return all;
  }

  /// A recording of a BIDS data set is several files; it is stored as one, in HDF5, which loses no number.
  Added add_of_bids(const std::filesystem::path& motion, const KnownFacts& facts) {
    std::error_code code;
    if (std::filesystem::is_directory(motion, code)) {
      return fail(ErrorKind::usage, "this is a folder", "'mbk study import' takes all recordings of a BIDS data set",
                  motion.string());
    }
    request::ReadRequest reading = request::reading_for(measuring_.request.reading, measuring_.options);
    reading.files = {motion};
    const auto reader = MBK_TRY(request::open_recordings(reading, measuring_.request.sensor));
    auto recording = MBK_TRY(reader.read(0));
    KnownFacts known = facts;
    const auto condition = recording.metadata.find("condition");  // in full; a name has only its letters and digits
    if (facts.condition && condition != recording.metadata.end() &&
        store::is_bids_label(*facts.condition, condition->second)) {
      known.condition = condition->second;
    }
    const auto trial = check(recording, known, {});
    if (!trial) return tl::unexpected(trial.error().in(motion.string()));
    auto incoming = MBK_TRY(study_.bring_in(motion));
    auto added = add_copy(incoming, std::move(recording), *trial, {});
    if (!added) return tl::unexpected(named(added.error(), incoming.path(), motion));
    return added;
  }

  /// Stores a recording as HDF5, without what may identify a person.
  /// @param incoming  what it was read from    @param unseen  what stays in that, and not in the recording
  Added add_copy(const store::IncomingFile& incoming, Recording recording, const store::TrialFacts& trial,
                 const std::vector<std::string>& unseen) {
    auto entries = store::identifying_entries(recording.metadata);
    for (const std::string& key : entries) recording.metadata.erase(key);
    entries.insert(entries.end(), unseen.begin(), unseen.end());
    if (!entries.empty()) options_.note(fmt::format("stored without: {}", fmt::join(entries, ", ")));
    // Beside the file that came in: what an interrupted process leaves there is tidied up.
    const std::filesystem::path made =
        incoming.path().parent_path() / (incoming.path().stem().string() + ".copy.h5.part");
    MBK_TRY(recording::write(recording, made, recording::Format::hdf5, true));
    auto copy = study_.bring_in(made, kCopyExtension);
    std::error_code ignored;
    std::filesystem::remove(made, ignored);
    if (!copy) return tl::unexpected(copy.error());
    const store::NewRecording one = to_store(0, trial, recording);
    return study_.add(std::move(*copy), {&one, 1}, incoming.sha256(), options_.role);
  }

  store::Store& study_;
  const Measuring& measuring_;
  const AddOptions& options_;
};

Added Adder::add(const std::filesystem::path& file, const KnownFacts& facts) {
  return File(study_, *measuring_, options_).add(file, facts);
}

Result<std::vector<store::SheetRow>> rows_of_bids(const std::filesystem::path& folder) {
  const auto runs = MBK_TRY(recording::find_bids_runs(folder));
  if (runs.empty()) {
    return fail(ErrorKind::data, "the folder has no BIDS recording (…_motion.tsv)",
                "name recordings, or the folder of a BIDS data set with motion data", folder.string());
  }
  std::vector<store::SheetRow> rows;
  for (const recording::BidsRun& run : runs) {
    const auto facts = store::facts_of_bids(run.motion.stem().string());
    if (!facts) return tl::unexpected(facts.error().in(run.motion.string()));
    const auto twin = std::ranges::find_if(rows, [&](const auto& row) { return alike(row.facts, *facts); });
    if (twin != rows.end()) {
      return fail(ErrorKind::data,
                  fmt::format("and {} are one trial, recorded by two tracking systems or twice",
                              twin->file.filename().string()),
                  "name the motion.tsv files to import", run.motion.string());
    }
    rows.push_back({run.motion, *facts});
  }
  return rows;
}

Result<ImportRows> rows_of_files(const std::vector<std::filesystem::path>& files, const std::string& pattern) {
  std::optional<store::NamePattern> names;
  if (!pattern.empty()) {
    names = MBK_TRY(store::NamePattern::of(pattern));
  }
  ImportRows import;
  for (const std::filesystem::path& file : files) {
    if (!names && recording::may_be_bids(file)) {
      const auto found = MBK_TRY(rows_of_bids(file));
      import.rows.insert(import.rows.end(), found.begin(), found.end());
      continue;
    }
    const auto facts = names ? names->match(file.filename().string()) : Result<KnownFacts>();
    if (facts) {
      import.rows.push_back({file, *facts});
    } else {
      import.failed.push_back(facts.error());
    }
  }
  return import;
}

}  // namespace mbk::workflow
