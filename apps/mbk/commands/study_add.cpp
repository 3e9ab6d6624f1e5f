#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/progress.h"
#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/options/study_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/experiment/protocol/personal_data.h"
#include "mbk/files/bids/read_run.h"
#include "mbk/files/c3d/c3d.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/read_text.h"
#include "mbk/files/kinarm/exam_parameters.h"
#include "mbk/files/recording/formats.h"
#include "mbk/files/recording/write.h"
#include "mbk/measure/preprocess/exclusions.h"
#include "mbk/study/store/identifying.h"
#include "mbk/study/store/trial_names.h"

namespace mbk::app {
namespace {

using store::AddedRecording;
using store::KnownFacts;

struct AddArguments {
  StudyArguments study;
  std::vector<std::filesystem::path> files;
  KnownFacts facts;
  std::string pattern;
  std::optional<std::filesystem::path> sheet;
  bool strip = false, quiet = false;
};

/// Puts files into a study, one by one.
class Adder {
 public:
  Adder(store::Store& study, std::shared_ptr<const Measuring> measuring, const AddArguments& arguments)
      : study_(study), measuring_(std::move(measuring)), arguments_(arguments) {}

  /// @param facts  whose trial it is, as far as that was said
  Result<std::vector<AddedRecording>> add(const std::filesystem::path& file, const KnownFacts& facts) {
    if (recording::may_be_bids(file)) return add_of_bids(file, facts);
    auto incoming = MBK_TRY(study_.bring_in(file));
    auto added = add(incoming, facts);
    if (!added) return tl::unexpected(named(added.error(), incoming.path(), file));
    return added;
  }

 private:
  using Added = Result<std::vector<AddedRecording>>;

  /// The error speaks of the file that was named, not of its copy.
  static Error named(Error error, const std::filesystem::path& copy, const std::filesystem::path& file) {
    const std::size_t at = error.where.find(copy.string());
    if (at == std::string::npos) return error.in(file.string());
    error.where.replace(at, copy.string().size(), file.string());
    return error;
  }

  Added add(store::IncomingFile& incoming, const KnownFacts& facts) {
    ReadRequest reading = reading_for(measuring_->arguments.reading, measuring_->options);
    reading.files = {incoming.path()};
    const auto reader = MBK_TRY(RecordingReader::of(reading, measuring_->arguments.sensor));
    if (facts.trial && reader.count() > 1) {
      return bad_usage(fmt::format("the file holds {} trials", reader.count()), "leave --trial out: they are counted");
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
    return study_.add(std::move(incoming), recordings, sha256, arguments_.study.role);
  }

  /// What the operator excluded is excluded in the study too; windows stay in the recording, and whoever measures it
  /// leaves them out. Both are said.
  store::NewRecording to_store(std::int64_t part, const store::TrialFacts& trial, const Recording& recording) const {
    const std::string exclusions = preprocess::exclusions_text(recording);
    if (const auto warning = protocol::personal_warning("the reason of an exclusion", exclusions, false);
        !warning.empty()) {
      say("mbk: {}\n", warning);
    }
    const auto windows = preprocess::excluded_windows(recording);
    if (!windows) {
      say("mbk: {}\n", windows.error().line());
    } else if (!windows->empty()) {
      say("mbk: the operator excluded windows, which measuring leaves out in default mode: {}\n",
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
    if (format.starts_with("KINARM")) return {"what the exam says of the person and its name"};
    if (format != "C3D") return {};
    const auto bytes = recording::read_file(file);
    if (!bytes) return {};
    const auto parameters = recording::decode_c3d_parameters(bytes->bytes());
    return parameters ? recording::ExamParameters::of(*parameters).personal_texts() : std::vector<std::string>();
  }

  Result<store::TrialFacts> check(const Recording& recording, const KnownFacts& facts,
                                  const std::vector<std::string>& unseen) const {
    const auto withdrawn = recording.metadata.find("withdrawn");
    if (withdrawn != recording.metadata.end() && withdrawn->second == "yes") {
      return bad_data("the person has withdrawn: these data must not be used", "remove the file");
    }
    auto identifying = store::identifying_entries(recording.metadata);
    identifying.insert(identifying.end(), unseen.begin(), unseen.end());
    if (!identifying.empty() && !arguments_.strip) {
      return bad_data(fmt::format("its metadata may identify a person: {}", fmt::join(identifying, ", ")),
                      "pass --strip to store a copy without these entries");
    }
    return facts.or_else(store::facts_of(recording.metadata)).complete();
  }

  /// What a file became when it was added before with --strip.
  Added find_stripped(const store::IncomingFile& incoming, const RecordingReader& reader, const KnownFacts& facts) {
    const auto there = MBK_TRY(study_.recordings_of(incoming.sha256()));
    std::vector<AddedRecording> found;
    for (const store::StoredRecording& one : there) {
      if (one.sha256 == one.origin_sha256) continue;
      if (facts.participant && *facts.participant != one.participant) {
        return bad_data(fmt::format("is there already, as recording {} of participant {}", one.number, one.participant),
                        "a file is the trial of one participant: check both");
      }
      found.push_back({one, true});
    }
    if (std::ssize(found) < reader.count()) found.clear();
    return found;
  }

  /// Each trial as a recording of its own, in HDF5, without what may identify a person.
  Added add_stripped(const store::IncomingFile& incoming, const RecordingReader& reader, const KnownFacts& facts,
                     const std::vector<std::string>& unseen) {
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
      return fail(ErrorKind::usage, "is a folder", "'mbk study import' takes all recordings of a BIDS data set",
                  motion.string());
    }
    ReadRequest reading = reading_for(measuring_->arguments.reading, measuring_->options);
    reading.files = {motion};
    const auto reader = MBK_TRY(RecordingReader::of(reading, measuring_->arguments.sensor));
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
    if (!entries.empty() && !arguments_.quiet) {
      say("mbk: stored without: {}\n", fmt::format("{}", fmt::join(entries, ", ")));
    }
    // Beside the file that came in: what an interrupted process leaves there is tidied up.
    const std::filesystem::path made =
        incoming.path().parent_path() / (incoming.path().stem().string() + ".copy.h5.part");
    MBK_TRY(recording::write(recording, made, recording::Format::hdf5, true));
    auto copy = study_.bring_in(made, kCopyExtension);
    std::error_code ignored;
    std::filesystem::remove(made, ignored);
    if (!copy) return tl::unexpected(copy.error());
    const store::NewRecording one = to_store(0, trial, recording);
    return study_.add(std::move(*copy), {&one, 1}, incoming.sha256(), arguments_.study.role);
  }

  store::Store& study_;
  std::shared_ptr<const Measuring> measuring_;
  const AddArguments& arguments_;
};

std::string added_line(const AddedRecording& added) {
  const store::StoredRecording& r = added.recording;
  return fmt::format("recording {}: participant {}, session {}, {}trial {}, {:.1f} s{}{}\n", r.number, r.participant,
                     r.session, r.condition.empty() ? "" : r.condition + ", ", r.trial, r.duration_s,
                     added.there_before ? " (there already)" : "",
                     r.excluded_why ? ", excluded: " + *r.excluded_why : "");
}

/// Adds all of them; one that cannot be added costs only itself.
int add_all(const AddArguments& arguments, const std::vector<store::SheetRow>& rows) {
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  const auto defaults = default_options(*study);
  if (!defaults) return report_error(defaults.error());
  auto measuring = measuring_of(*defaults);
  if (!measuring) return report_error(measuring.error());
  Adder adder(*study, std::move(*measuring), arguments);
  Progress progress(arguments.quiet);
  int code = kFine, done = 0;
  std::string text;
  for (const store::SheetRow& row : rows) {
    const auto added = adder.add(row.file, row.facts);
    progress.count(++done, static_cast<int>(rows.size()), row.file.string());
    if (!added) {
      code = std::max(code, report_error(added.error()));
      continue;
    }
    for (const AddedRecording& one : *added) {
      if (auto ok = print_text(added_line(one)); !ok) return report_error(ok.error());
    }
  }
  return code;
}

int run_add(const AddArguments& arguments) {
  if (arguments.facts.trial && arguments.files.size() > 1) {
    return report_error({ErrorKind::usage, "--trial numbers one file", "leave it out: trials are counted", ""});
  }
  std::vector<store::SheetRow> rows;
  for (const std::filesystem::path& file : arguments.files) rows.push_back({file, arguments.facts});
  return add_all(arguments, rows);
}

bool alike(const KnownFacts& one, const KnownFacts& other) {
  return one.participant == other.participant && one.session == other.session && one.condition == other.condition &&
         one.trial == other.trial;
}

/// The recordings of a BIDS data set, by their names.
Result<std::vector<store::SheetRow>> rows_of_bids(const std::filesystem::path& folder) {
  const auto runs = MBK_TRY(recording::find_bids_runs(folder));
  if (runs.empty()) {
    return fail(ErrorKind::data, "is a folder without a BIDS recording (…_motion.tsv)",
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
                  "name the motion.tsv files that are to be imported", run.motion.string());
    }
    rows.push_back({run.motion, *facts});
  }
  return rows;
}

int run_import(const AddArguments& arguments) {
  std::vector<store::SheetRow> rows;
  int code = kFine;
  if (arguments.sheet) {
    if (!arguments.files.empty()) {
      return report_error({ErrorKind::usage, "the sheet names the files", "name no FILE beside --sheet", ""});
    }
    const auto text = read_text(*arguments.sheet);
    if (!text) return report_error(text.error());
    auto sheet = store::read_sheet(*text, arguments.sheet->parent_path());
    if (!sheet) return report_error(sheet.error().in(arguments.sheet->string()));
    if (!sheet->ignored.empty() && !arguments.quiet) {
      say("mbk: {}: columns that are not kept: {}\n", arguments.sheet->string(),
          fmt::format("{}", fmt::join(sheet->ignored, ", ")));
    }
    rows = std::move(sheet->rows);
  } else {
    if (arguments.files.empty()) {
      return report_error({ErrorKind::usage, "nothing to import", "name recordings, or a table with --sheet", ""});
    }
    std::optional<store::NamePattern> pattern;
    if (!arguments.pattern.empty()) {
      auto made = store::NamePattern::of(arguments.pattern);
      if (!made) return report_error(made.error());
      pattern = std::move(*made);
    }
    for (const std::filesystem::path& file : arguments.files) {
      if (!pattern && recording::may_be_bids(file)) {
        const auto found = rows_of_bids(file);
        if (!found) return report_error(found.error());
        rows.insert(rows.end(), found->begin(), found->end());
        continue;
      }
      KnownFacts facts;
      if (pattern) {
        auto found = pattern->match(file.filename().string());
        if (!found) {
          code = std::max(code, report_error(found.error()));
          continue;
        }
        facts = *found;
      }
      rows.push_back({file, facts});
    }
  }
  for (store::SheetRow& row : rows) row.facts = row.facts.or_else(arguments.facts);
  return std::max(code, add_all(arguments, rows));
}

void add_fact_options(Command command, KnownFacts& facts) {
  constexpr long kLargest = 999999999;
  command.add_option("--session", facts.session, "which of the participant's sessions (as recorded, or 1)")
      .type_name("N")
      .check(whole_number(1, kLargest));
  command
      .add_option("--condition", facts.condition,
                  "what was asked of the participant: relaxed (as recorded, or none); name nobody")
      .type_name("WORD")
      .check(not_empty());
}

void add_common_options(Command command, AddArguments& arguments) {
  command.add_flag("--strip", arguments.strip,
                   "of a recording whose metadata may identify a person store a copy (HDF5) without those entries; "
                   "otherwise it is refused");
  add_study_and_role(command, arguments.study);
  command.add_flag("--quiet", arguments.quiet, "no progress and no notes on standard error");
}

}  // namespace

Action add_study_add(Command group) {
  auto arguments = std::make_shared<AddArguments>();
  const Command command = group.add_command("add", "recordings of one participant, session and condition");
  command.footer(
      "Examples:\n"
      "  mbk study add p07_relaxed.h5 --participant 7 --session 2 --condition relaxed\n"
      "  mbk study add trial_*.mat --participant 7\n"
      "      trials are counted on within participant, session and condition\n"
      "  mbk study add p07.h5\n"
      "      a recording of 'mbk run' says itself whose it is\n\n"
      "A file is copied into the study's folder; of its name only the end (.h5) is kept. One that is there\n"
      "already is not stored twice. The study's default options (mbk study defaults) say how it is read.");
  command.add_option("FILE", arguments->files, "recordings: " + recording::readable_files()).required();
  constexpr long kLargest = 999999999;
  command.add_option("--participant", arguments->facts.participant, "a number, never a name")
      .type_name("N")
      .check(whole_number(1, kLargest));
  add_fact_options(command, arguments->facts);
  command.add_option("--trial", arguments->facts.trial, "its number within participant, session and condition")
      .type_name("N")
      .check(whole_number(1, kLargest));
  add_common_options(command, *arguments);
  return [arguments] { return run_add(*arguments); };
}

Action add_study_import(Command group) {
  auto arguments = std::make_shared<AddArguments>();
  const Command command =
      group.add_command("import", "many recordings: whose they are from names, a sheet or metadata");
  command.footer(
      "Examples:\n"
      "  mbk study import recordings/*.h5\n"
      "      of 'mbk run': their metadata say participant and condition\n"
      "  mbk study import data/*.mat --pattern 'p{participant}_s{session}_{condition}_*.mat'\n"
      "      {participant}, {session}, {trial}: digits; {condition}: letters, digits and -; * anything\n"
      "  mbk study import --sheet trials.csv\n"
      "      columns file, participant and, where they are there, session, condition, trial\n"
      "  mbk study import data_set\n"
      "      a BIDS data set (Motion): sub-07_ses-2_task-relaxed_run-1 is participant 7, session 2, condition\n"
      "      relaxed, trial 1\n\n"
      "What neither name, sheet nor options say is taken from the recording's metadata.");
  command.add_option("FILE", arguments->files, "recordings: " + recording::readable_files());
  const Option pattern =
      command.add_option("--pattern", arguments->pattern, "what the names of the files say; nothing else is kept")
          .type_name("PATTERN")
          .check(not_empty());
  command.add_option("--sheet", arguments->sheet, "a CSV table that names the files, relative to its own folder")
      .type_name("SHEET.csv")
      .check(not_empty())
      .excludes(pattern);
  add_fact_options(command, arguments->facts);
  add_common_options(command, *arguments);
  return [arguments] { return run_import(*arguments); };
}

}  // namespace mbk::app
