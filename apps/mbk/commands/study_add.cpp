#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_listing.h"
#include "apps/mbk/options/study_options.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/files/contents/read_text.h"
#include "mbk/files/recording/formats.h"
#include "mbk/study/workflow/add_recordings.h"

namespace mbk::app {
namespace {

using store::AddedRecording;
using store::KnownFacts;

struct AddArguments {
  StudyArguments study;
  std::vector<std::filesystem::path> files;
  KnownFacts facts;
  std::string rater;  ///< as typed
  std::string pattern;
  std::optional<std::filesystem::path> sheet;
  bool strip = false, quiet = false;
};

std::string added_line(const AddedRecording& added) {
  const store::StoredRecording& r = added.recording;
  return fmt::format("{}, {:.1f} s{}{}\n", recording_words(r), r.duration_s,
                     added.there_before ? " (already stored)" : "",
                     r.excluded_why ? ", excluded: " + *r.excluded_why : "");
}

/// Adds all recordings. One that cannot be added does not stop the others.
int add_all(const AddArguments& arguments, const std::vector<store::SheetRow>& rows) {
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  const auto defaults = workflow::default_options(*study);
  if (!defaults) return report_error(defaults.error());
  auto measuring = workflow::measuring_of(*defaults);
  if (!measuring) return report_error(measuring.error());
  workflow::AddOptions options{.strip = arguments.strip, .role = arguments.study.role};
  options.warn = [](const std::string& warning) { say("mbk: {}\n", warning); };
  if (!arguments.quiet) options.note = options.warn;
  workflow::Adder adder(*study, std::move(*measuring), std::move(options));
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

/// The options' facts, with the rater as a code.
KnownFacts typed_facts(const AddArguments& arguments) {
  KnownFacts facts = arguments.facts;
  if (!arguments.rater.empty()) facts.rater = store::rater_code(arguments.rater);
  return facts;
}

int run_add(const AddArguments& arguments) {
  if (arguments.facts.trial && arguments.files.size() > 1) {
    return report_error({ErrorKind::usage, "--trial numbers one file, but several are named",
                         "omit --trial; trials are numbered automatically", ""});
  }
  std::vector<store::SheetRow> rows;
  for (const std::filesystem::path& file : arguments.files) rows.push_back({file, typed_facts(arguments)});
  return add_all(arguments, rows);
}

int run_import(const AddArguments& arguments) {
  std::vector<store::SheetRow> rows;
  int code = kFine;
  if (arguments.sheet) {
    if (!arguments.files.empty()) {
      return report_error({ErrorKind::usage, "both FILE and --sheet name recordings", "omit FILE or --sheet", ""});
    }
    const auto text = read_text(*arguments.sheet);
    if (!text) return report_error(text.error());
    auto sheet = store::read_sheet(*text, arguments.sheet->parent_path());
    if (!sheet) return report_error(sheet.error().in(arguments.sheet->string()));
    if (!sheet->ignored.empty() && !arguments.quiet) {
      say("mbk: {}: columns that are not stored: {}\n", arguments.sheet->string(),
          fmt::format("{}", fmt::join(sheet->ignored, ", ")));
    }
    rows = std::move(sheet->rows);
  } else {
    if (arguments.files.empty()) {
      return report_error({ErrorKind::usage, "no recording is named", "name recordings, or a table with --sheet", ""});
    }
    auto import = workflow::rows_of_files(arguments.files, arguments.pattern);
    if (!import) return report_error(import.error());
    for (const Error& error : import->failed) code = std::max(code, report_error(error));
    rows = std::move(import->rows);
  }
  for (store::SheetRow& row : rows) row.facts = row.facts.or_else(typed_facts(arguments));
  return std::max(code, add_all(arguments, rows));
}

OptionCheck rater_code() {
  return {[](const std::string& given) -> std::string {
    return store::rater_code(given) ? "" : fmt::format("not a code: {}", store::kRaterAdvice);
  }};
}

void add_fact_options(Command command, AddArguments& arguments) {
  KnownFacts& facts = arguments.facts;
  constexpr std::int64_t kLargest = 999999999;
  command.add_option("--session", facts.session, "number of the participant's session (default: as recorded, or 1)")
      .type_name("N")
      .check(whole_number(1, kLargest));
  command
      .add_option(
          "--condition", facts.condition,
          "instruction to the participant, such as relaxed (default: as recorded, or none); not a person's name")
      .type_name("WORD")
      .check(not_empty());
  command
      .add_option("--rater", arguments.rater,
                  "who measured: a number or a code such as A or R2, never a name (default: as recorded, or none)")
      .type_name("CODE")
      .check(rater_code());
}

void add_common_options(Command command, AddArguments& arguments) {
  command.add_flag("--strip", arguments.strip,
                   "if metadata may identify a person, store a copy (HDF5) without these entries (default: reject the "
                   "recording)");
  add_study_and_role(command, arguments.study);
  command.add_flag("--quiet", arguments.quiet, "print no progress and no notes on standard error");
}

}  // namespace

Action add_study_add(Command group) {
  auto arguments = std::make_shared<AddArguments>();
  const Command command = group.add_command("add", "add recordings of one participant, session and condition");
  command.footer(
      "Examples:\n"
      "  mbk study add p07_relaxed.h5 --participant 7 --session 2 --condition relaxed\n"
      "  mbk study add trial_*.mat --participant 7\n"
      "      numbers the trials within participant, session and condition\n"
      "  mbk study add p07_a.h5 --participant 7 --rater A\n"
      "  mbk study add p07.h5\n"
      "      a recording of 'mbk run' contains participant and condition\n\n"
      "A file is copied into the folder of the study; only the extension of its name (.h5) is kept. A\n"
      "file is not stored twice. The default options of the study (mbk study defaults) determine how it\n"
      "is read.");
  command.add_option("FILE", arguments->files, "recordings: " + recording::readable_files()).required();
  constexpr std::int64_t kLargest = 999999999;
  command.add_option("--participant", arguments->facts.participant, "number of the participant, never a name")
      .type_name("N")
      .check(whole_number(1, kLargest));
  add_fact_options(command, *arguments);
  command.add_option("--trial", arguments->facts.trial, "number of the trial within participant, session and condition")
      .type_name("N")
      .check(whole_number(1, kLargest));
  add_common_options(command, *arguments);
  return [arguments] { return run_add(*arguments); };
}

Action add_study_import(Command group) {
  auto arguments = std::make_shared<AddArguments>();
  const Command command =
      group.add_command("import", "add many recordings, assigned to participants by file name, table or metadata");
  command.footer(
      "Examples:\n"
      "  mbk study import recordings/*.h5\n"
      "      recordings of 'mbk run', whose metadata contain participant and condition\n"
      "  mbk study import data/*.mat --pattern 'p{participant}_s{session}_{condition}_*.mat'\n"
      "      {participant}, {session}, {trial}: digits; {condition}: letters, digits and -; {rater}: a code;\n"
      "      * anything\n"
      "  mbk study import --sheet trials.csv\n"
      "      columns file, participant and optionally session, condition, trial, rater\n"
      "  mbk study import data_set\n"
      "      a BIDS data set (Motion): sub-07_ses-2_task-relaxed_run-1 is participant 7, session 2, condition\n"
      "      relaxed, trial 1\n\n"
      "Facts that are in neither name, table nor options are taken from the metadata of the recording.");
  command.add_option("FILE", arguments->files, "recordings: " + recording::readable_files());
  const Option pattern =
      command.add_option("--pattern", arguments->pattern, "pattern of the file names; nothing else of them is stored")
          .type_name("PATTERN")
          .check(not_empty());
  command.add_option("--sheet", arguments->sheet, "CSV table that lists the files, relative to its own folder")
      .type_name("SHEET.csv")
      .check(not_empty())
      .excludes(pattern);
  add_fact_options(command, *arguments);
  add_common_options(command, *arguments);
  return [arguments] { return run_import(*arguments); };
}

}  // namespace mbk::app
