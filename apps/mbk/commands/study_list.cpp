#include "mbk/study/store/study_list.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_listing.h"
#include "apps/mbk/options/study_options.h"
#include "apps/mbk/options/word_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/present/report/text.h"
#include "mbk/study/statistics/study_statistics_text.h"
#include "mbk/study/workflow/export_bids.h"

namespace mbk::app {
namespace {

using store::ListedRecording;
using store::RecordingState;
using store::StudyList;

enum class ExportFormat { csv, json, latex };

constexpr auto word_table(ExportFormat) {
  using enum ExportFormat;
  return std::to_array<Word<ExportFormat>>({{csv, "csv"}, {json, "json"}, {latex, "latex"}});
}

struct ListArguments : AnalysisArguments {
  std::int64_t recording = 0;
  bool document = false;
  ExportFormat format = ExportFormat::csv;
  std::optional<std::filesystem::path> bids;
};

std::string analysis_line(const store::Analysis& analysis) {
  const auto options = workflow::options_from_json(analysis.options);
  const std::string text = options ? typed_text(*options) : analysis.options;
  return fmt::format("analysis {}: mbk {}, {}\n", analysis.number, analysis.version,
                     text.empty() ? "default options" : text);
}

/// "3 usable, 1 not usable, 2 not measured": those that there are.
std::string counts_text(const StudyList& list) {
  std::string text = fmt::format("{} of {}", counted(std::ssize(list.recordings), "recording", "recordings"),
                                 counted(list.participants(), "participant", "participants"));
  std::string separator = ": ";
  for (const auto& [state, word] : kWords<RecordingState>) {
    const std::int64_t count = list.count(state);
    if (count == 0) continue;
    std::string words(word);
    std::ranges::replace(words, '-', ' ');
    text += fmt::format("{}{} {}", std::exchange(separator, ", "), count, words);
  }
  return text + "\n";
}

std::string list_text(const StudyList& list) {
  std::string text = study_head_text(list);
  if (list.recordings.empty()) return text + "  add recordings with 'mbk study add' or 'mbk study import'\n";
  std::size_t width = 9;
  for (const ListedRecording& one : list.recordings) width = std::max(width, one.recording.condition.size());
  const bool raters = list.has_raters();
  const auto rater = [&](const std::string& code) { return raters ? fmt::format("{:>5}  ", code) : std::string(); };
  text += fmt::format("\n{:>9}  {:>11}  {:>7}  {:<{}}  {}{:>5}  {:>6}  state\n", "recording", "participant", "session",
                      "condition", width, rater("rater"), "trial", "s");
  for (const ListedRecording& one : list.recordings) {
    const store::StoredRecording& r = one.recording;
    std::string state(word_of(one.state));
    std::ranges::replace(state, '-', ' ');
    text += fmt::format("{:>9}  {:>11}  {:>7}  {:<{}}  {}{:>5}  {:>6.1f}  {}{}\n", r.number, r.participant, r.session,
                        r.condition, width, rater(r.rater), r.trial, r.duration_s, state,
                        one.reason.empty() ? "" : ": " + one.reason);
  }
  return text;
}

std::string outcome_line(const store::Outcome& one) {
  const std::string error = one.standard_error ? fmt::format("{:.3g}", *one.standard_error) : "";
  return fmt::format("    {:<24}  {:>12.6g}  {:>15}  {}\n", one.name, one.value, error, one.unit);
}

std::string show_text(const store::ShownRecording& shown) {
  const store::StoredRecording& r = shown.recording;
  std::string text = recording_words(r) + "\n";
  text += fmt::format("  sha256   {}\n", r.sha256);
  if (r.origin_sha256 != r.sha256) text += fmt::format("  made of  {}\n", r.origin_sha256);
  if (r.part > 0) text += fmt::format("  part     {} of its file\n", r.part);
  text += fmt::format("  length   {:.3f} s, {} bytes\n  added    {}\n", r.duration_s, r.bytes, r.added);
  if (r.excluded_why) text += fmt::format("  excluded {}\n", *r.excluded_why);
  if (shown.results.empty()) return text + "\n  not measured\n";
  for (const auto& [result, analysis, outcomes] : shown.results) {
    text += "\n  " + analysis_line(analysis);
    text += result.usable   ? "  usable\n"
            : result.failed ? "  could not be measured: " + result.reason + "\n"
                            : "  not usable: " + result.reason + "\n";
    // Numbers of an unusable model are not shown; --json contains them.
    if (!result.usable) continue;
    text += fmt::format("    {:<24}  {:>12}  {:>15}\n", "outcome", "value", "standard error");
    for (const store::Outcome& one : outcomes) text += outcome_line(one);
  }
  return text;
}

/// For people, or the document that --json asks for.
int show(const ListArguments& arguments, const store::Store& study, const std::string& text) {
  if (auto ok = arguments.output.write(text, {study.folder()}); !ok) return report_error(ok.error());
  return kFine;
}

/// For programs.
int write(const ListArguments& arguments, const store::Store& study, const std::string& text) {
  if (auto ok = arguments.output.to.write(text, {study.folder()}); !ok) return report_error(ok.error());
  return kFine;
}

/// The table of 'mbk study summary --format latex'.
Result<std::string> export_latex(const store::Store& study, const StudyList& list) {
  store::OutcomeColumns columns;
  if (list.analysis) {
    columns = MBK_TRY(study.columns(list.analysis->number));
  }
  statistics::add_matrix_numbers(columns);
  const auto found = MBK_TRY(statistics::study_statistics(columns));
  return statistics::summary_latex(list, store::summarise_outcomes(columns), found);
}

int run_list(const ListArguments& arguments) {
  std::optional<store::Store> study;
  const auto list = listed_study(arguments, study);
  if (!list) return report_error(list.error());
  return show(arguments, *study, arguments.output.json ? store::to_json(*list) : list_text(*list));
}

int run_show(const ListArguments& arguments) {
  if (auto ok = check_files({}, arguments.output.to); !ok) return report_error(ok.error());
  const auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  const auto shown = store::show_recording(*study, arguments.recording);
  if (!shown) return report_error(shown.error());
  if (!arguments.document)
    return show(arguments, *study, arguments.output.json ? store::to_json(*shown) : show_text(*shown));
  const auto list = store::list_study(*study, arguments.analysis);
  if (!list) return report_error(list.error());
  for (const auto& one : shown->results) {
    if (!list->analysis || one.analysis.number != list->analysis->number || one.result.failed) continue;
    const auto document = study->document(one.result.number);
    if (!document) return report_error(document.error());
    return write(arguments, *study, *document + "\n");
  }
  return report_error({ErrorKind::data, fmt::format("recording {} has no result", arguments.recording),
                       "run 'mbk study measure'; 'mbk study list' shows the state", ""});
}

int export_bids(const store::Store& study, const StudyList& list, const std::filesystem::path& folder) {
  const auto exported = workflow::export_bids(study, list, folder);
  if (!exported) return report_error(exported.error());
  int code = kFine;
  for (const Error& error : exported->failed) code = std::max(code, report_error(error));
  for (const std::string& one : exported->lost) say("mbk: {}: not written: {}\n", folder.string(), one);
  if (!exported->excluded.empty()) {
    say("mbk: {} omitted because excluded: {}\n", counted(std::ssize(exported->excluded), "recording", "recordings"),
        fmt::format("{}", fmt::join(exported->excluded, ", ")));
  }
  const std::string line =
      fmt::format("{}: BIDS motion, {}\n", folder.string(), counted(exported->written, "recording", "recordings"));
  if (auto ok = print_text(line); !ok) return report_error(ok.error());
  return code;
}

int run_export(const ListArguments& arguments) {
  std::optional<store::Store> study;
  const auto list = listed_study(arguments, study);
  if (!list) return report_error(list.error());
  if (arguments.bids) return export_bids(*study, *list, *arguments.bids);
  const auto text = arguments.format == ExportFormat::latex ? export_latex(*study, *list)
                    : arguments.format == ExportFormat::csv ? store::export_csv(*study, *list)
                                                            : store::export_json(*study, *list);
  if (!text) return report_error(text.error());
  const int code = write(arguments, *study, *text);
  if (code == kFine && arguments.output.to.file)
    say_written(arguments.output.to.file->string(), arguments.output.quiet);
  return code;
}

}  // namespace

void add_analysis_option(Command command, AnalysisArguments& arguments) {
  command.add_option("--analysis", arguments.analysis, "number of the analysis (default: that of the newest result)")
      .type_name("N")
      .check(whole_number(1, 999999999));
}

std::string recording_words(const store::StoredRecording& r) {
  return fmt::format("recording {}: participant {}, session {}, {}{}trial {}", r.number, r.participant, r.session,
                     r.condition.empty() ? "" : r.condition + ", ", r.rater.empty() ? "" : "rater " + r.rater + ", ",
                     r.trial);
}

std::string study_head_text(const StudyList& list) {
  std::string text = list.facts.title.empty() ? "" : list.facts.title + "\n";
  text += counts_text(list);
  for (const store::Analysis& one : list.analyses) {
    text += (list.analysis && one.number == list.analysis->number && list.analyses.size() > 1 ? "* " : "  ") +
            analysis_line(one);
  }
  return text;
}

Result<StudyList> listed_study(const AnalysisArguments& arguments, std::optional<store::Store>& study) {
  MBK_TRY(check_files({}, arguments.output.to));
  auto opened = MBK_TRY(open_study(arguments.study));
  study.emplace(std::move(opened));
  return store::list_study(*study, arguments.analysis);
}

Action add_study_list(Command group) {
  auto arguments = std::make_shared<ListArguments>();
  const Command command = group.add_command("list", "list the recordings and the state of their results");
  command.footer(
      "Examples:\n"
      "  mbk study list\n"
      "  mbk study list --study arms --json\n"
      "  mbk study list --analysis 1\n"
      "      states in an earlier analysis, with other options");
  add_study_option(command, arguments->study);
  add_analysis_option(command, *arguments);
  add_output_options(command, arguments->output, "mbk.study_list/1");
  return [arguments] { return run_list(*arguments); };
}

Action add_study_show(Command group) {
  auto arguments = std::make_shared<ListArguments>();
  const Command command = group.add_command("show", "show one recording with its results");
  command.footer(
      "Examples:\n"
      "  mbk study show 12\n"
      "  mbk study show 12 --result --out result.json\n"
      "      writes the whole result, for 'mbk ellipse', 'mbk passivity' and 'mbk compare'");
  command.add_option("N", arguments->recording, "number of the recording, as shown by 'mbk study list'")
      .required()
      .check(whole_number(1, 999999999));
  add_study_option(command, arguments->study);
  command.add_flag("--result", arguments->document, "print the result as 'mbk measure --json' does (mbk.result/2)");
  add_analysis_option(command, *arguments);
  add_output_options(command, arguments->output, "mbk.study_show/1");
  return [arguments] { return run_show(*arguments); };
}

Action add_study_export(Command group) {
  auto arguments = std::make_shared<ListArguments>();
  const Command command = group.add_command("export", "export every number, for R, pandas or a paper");
  command.footer(
      "Examples:\n"
      "  mbk study export --out outcomes.csv\n"
      "      one row for each number: participant, session, condition, trial, outcome, value, standard_error\n"
      "  mbk study export --format json --out study.json\n"
      "  mbk study export --format latex\n"
      "      the table of 'mbk study summary --format latex'\n"
      "  mbk study export --bids data_set\n"
      "      the recordings as a BIDS data set (Motion), without excluded ones; condition is the task, trial the "
      "run,\n"
      "      rater the acquisition (acq-raterA)\n\n"
      "The export also contains unusable results and excluded recordings, with their state: select state\n"
      "== 'usable'.");
  add_study_option(command, arguments->study);
  add_analysis_option(command, *arguments);
  const Option format =
      add_choice(command, "--format", arguments->format,
                 "csv: a tidy table; json: schema mbk.study_export/1; latex: a table for a paper (default: csv)");
  arguments->output.to.add_options(command);
  command.add_flag("--quiet", arguments->output.quiet, "do not name the file written on standard error");
  command
      .add_option("--bids", arguments->bids,
                  "export the recordings instead of numbers, to a new folder in BIDS Motion format; forces are "
                  "channels of type MISC")
      .type_name("FOLDER")
      .check(not_empty())
      .excludes(format)
      .excludes(command.get_option("--out"));
  return [arguments] { return run_export(*arguments); };
}

}  // namespace mbk::app
