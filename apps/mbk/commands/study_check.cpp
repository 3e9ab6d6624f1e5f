#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/options/study_options.h"
#include "apps/mbk/options/threads_option.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/study/store/study_list.h"
#include "mbk/study/workflow/measure_study.h"

namespace mbk::app {
namespace {

struct CheckArguments {
  StudyArguments study;
  OutputArguments output;
  bool quick = false, remove_leftovers = false, verify = false, undo = false, link = false;
  unsigned threads = 0;
  std::string head, why;
  std::int64_t number = 0;
  std::filesystem::path to;
};

std::string check_text(const store::CheckReport& report, bool quick) {
  std::string text;
  for (const std::string& problem : report.problems) text += "! " + problem + "\n";
  for (const std::string& note : report.notes) text += "  " + note + "\n";
  text += fmt::format("{}, {:.1f} MB: ", counted(report.recordings, "recording", "recordings"),
                      1e-6 * static_cast<double>(report.bytes));
  text += fmt::format("{} with an unchanged hash\n", counted(report.files, "file", "files"));
  text += counted(report.results, "result", "results");
  text += quick ? ", not measured again\n" : fmt::format(", {} reproduced by measuring again\n", report.repeated);
  text += fmt::format("{} of the log, head {}\n", counted(report.log_lines, "line", "lines"), report.head);
  return text + (report.problems.empty() ? "no problem found\n"
                                         : counted(std::ssize(report.problems), "problem", "problems") +
                                               ": restore what is missing or changed from a backup\n");
}

int run_check(const CheckArguments& arguments) {
  if (auto ok = check_files({}, arguments.output.to); !ok) return report_error(ok.error());
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  Progress progress(arguments.output.quiet, "files: ");
  auto report = study->check(arguments.remove_leftovers, [&](int done, int of) { progress.count(done, of); });
  if (!report) return report_error(report.error());
  if (!arguments.quick) {
    Progress again(arguments.output.quiet, "measured again: ");
    const auto count = [&](int done, int of) { again.count(done, of); };
    if (auto ok = workflow::repeat_results(*study, arguments.threads, count, *report); !ok) {
      return report_error(ok.error());
    }
  }
  const std::string text = arguments.output.json ? store::to_json(*report) : check_text(*report, arguments.quick);
  if (auto ok = arguments.output.write(text, {study->folder()}); !ok) return report_error(ok.error());
  return report->problems.empty() ? kFine : kBadData;
}

std::string line_text(const store::LogLine& line) {
  std::string what(word_of(line.action));
  if (line.recording) what += fmt::format(" recording {}", *line.recording);
  if (line.analysis) what += fmt::format(", analysis {}", *line.analysis);
  if (line.participant) what += fmt::format(" participant {}", *line.participant);
  return fmt::format("{:>5} {} {:<12} {}  {}{}\n", line.number, line.time, word_of(line.role), line.hash.substr(0, 12),
                     what, line.why.empty() ? "" : ": " + line.why);
}

int run_log(const CheckArguments& arguments) {
  if (auto ok = check_files({}, arguments.output.to); !ok) return report_error(ok.error());
  const auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  const auto lines = study->log();
  if (!lines) return report_error(lines.error());
  std::optional<store::LogVerdict> verdict;
  if (arguments.verify) {
    auto found = study->verify_log(arguments.head);
    if (!found) return report_error(found.error());
    verdict = std::move(*found);
  }
  std::string text;
  if (arguments.output.json) {
    text = store::to_json(*lines, verdict);
  } else if (verdict) {
    for (const std::string& problem : verdict->problems) text += "! " + problem + "\n";
    text += fmt::format("{}{}\nhead {}\n", counted(verdict->lines, "line", "lines"),
                        verdict->problems.empty() ? ", each as it was written" : "", verdict->head);
  } else {
    for (const store::LogLine& line : *lines) text += line_text(line);
    text += fmt::format("head {}\n", lines->empty() ? "" : lines->back().hash);
  }
  if (auto ok = arguments.output.write(text, {study->folder()}); !ok) return report_error(ok.error());
  return verdict && !verdict->problems.empty() ? kBadData : kFine;
}

int run_exclude(const CheckArguments& arguments) {
  if (!arguments.undo && arguments.why.empty()) {
    return report_error(
        {ErrorKind::usage, "--why is missing", "give the reason; it stays in the log, so name nobody", ""});
  }
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  const auto done = arguments.undo ? study->include(arguments.number, arguments.why, arguments.study.role)
                                   : study->exclude(arguments.number, arguments.why, arguments.study.role);
  if (!done) return report_error(done.error());
  const std::string text =
      fmt::format("recording {} {}\n", arguments.number, arguments.undo ? "included again" : "excluded");
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

int run_forget(const CheckArguments& arguments) {
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  const auto forgotten = study->forget(arguments.number, arguments.why, arguments.study.role);
  if (!forgotten) return report_error(forgotten.error());
  std::string text =
      fmt::format("participant {} forgotten: {}, {}, {} erased\n", arguments.number,
                  counted(forgotten->recordings, "recording", "recordings"),
                  counted(forgotten->results, "result", "results"), counted(forgotten->files, "file", "files"));
  text += "backups, exported tables and the files that were added are elsewhere: erase them too\n";
  if (!forgotten->lines_with_reasons.empty()) {
    text += fmt::format("the log keeps the reasons that were given for these recordings, in {} {}: {}\n",
                        forgotten->lines_with_reasons.size() == 1 ? "line" : "lines",
                        fmt::join(forgotten->lines_with_reasons, ", "),
                        "'mbk study log' shows them; if one names a person, only a new study leaves it out");
  }
  if (!forgotten->log_of_changes_emptied) {
    text +=
        "another process is reading: erased rows remain in study.sqlite-wal until it ends and another command runs\n";
  }
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

int run_backup(const CheckArguments& arguments) {
  auto study = open_study(arguments.study);
  if (!study) return report_error(study.error());
  const auto report = study->backup(arguments.to, arguments.link);
  if (!report) return report_error(report.error());
  const std::string text = fmt::format("{}: {}, {}, checked\nhead {}\n", arguments.to.string(),
                                       counted(report->recordings, "recording", "recordings"),
                                       counted(report->results, "result", "results"), report->head);
  if (auto ok = print_text(text); !ok) return report_error(ok.error());
  return kFine;
}

Option add_why_option(Command command, std::string& why) {
  return command.add_option("--why", why, "reason, recorded in the log; do not name a person")
      .type_name("TEXT")
      .check(not_empty());
}

}  // namespace

Action add_study_exclude(Command group) {
  auto arguments = std::make_shared<CheckArguments>();
  const Command command = group.add_command("exclude", "exclude a recording from summaries, with the reason");
  command.footer(
      "Examples:\n"
      "  mbk study exclude 12 --why \"hand slipped off the handle\"\n"
      "  mbk study exclude 12 --undo\n\n"
      "Nothing is erased. The recording remains in lists and exports, with the reason.");
  command.add_option("N", arguments->number, "number of the recording, as shown by 'mbk study list'")
      .required()
      .check(whole_number(1, 999999999));
  add_why_option(command, arguments->why)
      .description("reason, recorded in the log; do not name a person (optional with --undo)");
  command.add_flag("--undo", arguments->undo, "include the recording again");
  add_study_and_role(command, arguments->study);
  return [arguments] { return run_exclude(*arguments); };
}

Action add_study_forget(Command group) {
  auto arguments = std::make_shared<CheckArguments>();
  const Command command = group.add_command("forget", "erase a participant's recordings and results");
  command.footer(
      "Examples:\n"
      "  mbk study forget --participant 7 --why \"consent withdrawn\"\n\n"
      "Recordings and results are removed, and their rows in the database are overwritten with zeros. The\n"
      "log keeps a record without data that they existed and were erased. A disk may still contain traces\n"
      "of removed files. Backups are not changed.");
  command.add_option("--participant", arguments->number, "number of the participant")
      .type_name("N")
      .required()
      .check(whole_number(1, 999999999));
  add_why_option(command, arguments->why).required();
  add_study_and_role(command, arguments->study);
  return [arguments] { return run_forget(*arguments); };
}

Action add_study_check(Command group) {
  auto arguments = std::make_shared<CheckArguments>();
  const Command command = group.add_command("check", "check that the data are unchanged and the results reproducible");
  command.footer(
      "Examples:\n"
      "  mbk study check\n"
      "      checks the hash of every file, the database and the log; measures every result of this version again\n"
      "  mbk study check --quick\n"
      "      does not measure again\n\n"
      "Incomplete files of an interrupted process are removed and reported.\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 something is missing or has changed.");
  command.add_flag("--quick", arguments->quick, "do not measure again");
  command.add_flag("--remove-leftovers", arguments->remove_leftovers,
                   "also remove complete files that no recording refers to");
  add_threads_option(command, arguments->threads, "number of recordings measured in parallel");
  add_study_option(command, arguments->study);
  add_output_options(command, arguments->output, "mbk.study_check/1");
  return [arguments] { return run_check(*arguments); };
}

Action add_study_log(Command group) {
  auto arguments = std::make_shared<CheckArguments>();
  const Command command = group.add_command("log", "show the log: who did what, when and why");
  command.footer(
      "Examples:\n"
      "  mbk study log\n"
      "      the last line is the head: keep a copy where no one who can change the log can change it\n"
      "  mbk study log --verify --head 3f0c…\n"
      "      also checks that the log still contains the line with this head\n\n"
      "Each line contains the hash of the previous one, so that a changed, removed or inserted line is\n"
      "detected. Anyone who can write the file can rewrite the whole log or cut its end; only a head that\n"
      "was kept elsewhere, or a backup, reveals that. Reading a study is not logged.\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 the log has been changed.");
  const Option verify = command.add_flag("--verify", arguments->verify, "recompute and check every hash");
  command.add_option("--head", arguments->head, "a head that was kept: 64 hexadecimal digits")
      .type_name("HASH")
      .check([](const std::string& given) {
        const bool fits = given.size() == 64 && given.find_first_not_of("0123456789abcdef") == std::string::npos;
        return fits ? "" : fmt::format("{} is not 64 hexadecimal digits", quoted(given));
      })
      .needs(verify);
  add_study_option(command, arguments->study);
  add_output_options(command, arguments->output, "mbk.study_log/1");
  return [arguments] { return run_log(*arguments); };
}

Action add_study_backup(Command group) {
  auto arguments = std::make_shared<CheckArguments>();
  const Command command = group.add_command("backup", "copy the whole study and check the copy");
  command.footer(
      "Examples:\n"
      "  mbk study backup /media/backup/arms-2026-05-04\n"
      "  mbk study backup ../arms-before --link\n"
      "      on the same disk without using space: protects against mistakes, not against a disk failure\n\n"
      "Others can work during the backup. To restore, copy the folder back.");
  command.add_option("FOLDER", arguments->to, "folder of the backup, which must not exist yet").required();
  command.add_flag("--link", arguments->link, "create hard links to the recordings instead of copies, if possible");
  add_study_option(command, arguments->study);
  return [arguments] { return run_backup(*arguments); };
}

}  // namespace mbk::app
