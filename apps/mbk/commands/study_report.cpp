#include "mbk/study/longitudinal/study_report.h"

#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_listing.h"
#include "apps/mbk/options/report_file.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/printable.h"
#include "mbk/files/recording/write_file.h"
#include "mbk/present/report/html.h"

namespace mbk::app {
namespace {

struct StudyReportArguments : AnalysisArguments {
  std::optional<std::int64_t> participant;
  std::string outcome, note;
  ComparingArguments comparing;
};

/// The command that reproduces the page, without file names, which may name people.
std::string command_of(const StudyReportArguments& arguments, const store::StudyList& list) {
  std::string text = "mbk study report";
  if (arguments.participant) text += fmt::format(" --participant {}", *arguments.participant);
  if (list.analysis) text += fmt::format(" --analysis {}", list.analysis->number);
  if (!arguments.outcome.empty()) text += " --outcome " + arguments.outcome;
  if (!arguments.comparing.compare.empty()) text += " --compare";
  for (const std::string& word : arguments.comparing.compare) text += " " + shell_word(word);
  for (const std::string& group : arguments.comparing.groups) text += " --group " + shell_word(group);
  return text + (arguments.participant ? fmt::format(" --out participant_{}.html", *arguments.participant)
                                       : " --out study.html");
}

/// With --participant, --group names the controls.
Result<std::optional<statistics::PeopleGroup>> controls_of(const StudyReportArguments& arguments) {
  if (!arguments.participant) return std::nullopt;
  const auto groups = MBK_TRY(people_groups(arguments.comparing));
  if (groups.size() > 1) {
    return bad_usage("with --participant, --group names one group: the controls", "omit the other groups");
  }
  return groups.empty() ? std::nullopt : std::optional(groups.front());
}

Result<std::string> document_of(const StudyReportArguments& arguments, const store::Store& study,
                                store::StudyList list) {
  store::OutcomeColumns columns;
  if (list.analysis) {
    columns = MBK_TRY(study.columns(list.analysis->number));
  }
  statistics::add_matrix_numbers(columns);
  const auto controls = MBK_TRY(controls_of(arguments));
  const auto options =
      arguments.participant ? statistics::StatisticsOptions() : MBK_TRY(statistics_options(arguments.comparing));
  auto extents = MBK_TRY(longitudinal::stretch_extents(study, list, columns));
  auto statistics = MBK_TRY(statistics::study_statistics(
      arguments.participant ? longitudinal::comparable_columns(columns, extents, *arguments.participant) : columns,
      options));
  const std::string command = command_of(arguments, list);
  auto report = MBK_TRY(longitudinal::study_report(std::move(list), std::move(columns), std::move(statistics),
                                                   arguments.participant, arguments.outcome, std::move(extents)));
  report.command = command;
  report.note = printable(arguments.note);
  if (arguments.participant) {
    report.comparison = MBK_TRY(longitudinal::compare_participant(study, report, *arguments.participant, controls));
  }
  return arguments.participant ? longitudinal::participant_report_json(report, *arguments.participant)
                               : longitudinal::study_report_json(report);
}

int run_report(const StudyReportArguments& arguments) {
  const Output& to = arguments.output.to;
  if (auto ok = check_files({}, to); !ok) return report_error(ok.error());
  if (auto page = report::page("", {}); !page && !arguments.output.json) return report_error(page.error());
  std::optional<store::Store> study;
  auto list = listed_study(arguments, study);
  if (!list) return report_error(list.error());
  const auto document = document_of(arguments, *study, std::move(*list));
  if (!document) return report_error(document.error());
  const auto page = arguments.output.json
                        ? document
                        : report::page(*document, {"'mbk study summary' prints the tables of this page as text.", {}});
  if (!page) return report_error(page.error());
  if (auto ok = recording::write_file(*to.file, to.overwrite, *page, Readers::owner); !ok)
    return report_error(ok.error());
  say_written(to.file->string(), arguments.output.quiet);
  return kFine;
}

}  // namespace

Action add_study_report(Command group) {
  auto arguments = std::make_shared<StudyReportArguments>();
  const Command command = group.add_command("report", "write an HTML report of the study, or of one participant");
  command.footer(
      "Examples:\n"
      "  mbk study report --out study.html\n"
      "      reliability, participants, sessions, ellipses, exclusions with their reasons\n"
      "  mbk study report --participant 7 --out participant_7.html\n"
      "      changes since the first session, compared with the minimal detectable change\n"
      "  mbk study report --participant 7 --group controls=21-30 --out participant_7.html\n"
      "      also the last session beside the range of these participants; left beside right, if conditions\n"
      "      are named so\n"
      "  mbk study report --outcome K_xx --compare condition relaxed tensed --out study.html\n\n"
      "A report is one file that needs no network. It prints on A4, and its data can be saved from it. It\n"
      "contains health data: treat it as such. The report of a participant contains no numbers of other\n"
      "people but those that describe all of them, or all controls, together.");
  add_study_option(command, arguments->study);
  add_analysis_option(command, *arguments);
  const Option participant = command.add_option("--participant", arguments->participant, "report on this participant")
                                 .type_name("N")
                                 .check(whole_number(1, 999999999));
  command
      .add_option("--outcome", arguments->outcome,
                  "outcome shown first (default: stiffness_lambda_max, or another stiffness)")
      .type_name("NAME")
      .check(not_empty());
  add_comparing_options(command, arguments->comparing);
  command.get_option("--compare").excludes(participant);
  command.get_option("--group").description(
      "a group and its participants: patients=1-10,12; with --participant: the controls");
  command.add_option("--note", arguments->note, "a line below the title, such as a date; mbk adds none")
      .type_name("TEXT");
  add_output_options(command, arguments->output, "mbk.study_report/1, mbk.participant_report/1");
  command.get_option("--out").required().description("the report to write");
  return [arguments] { return run_report(*arguments); };
}

}  // namespace mbk::app
