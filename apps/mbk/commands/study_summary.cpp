#include "mbk/study/store/study_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <memory>
#include <string_view>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_listing.h"
#include "apps/mbk/options/engine_options.h"
#include "apps/mbk/options/word_options.h"
#include "apps/mbk/terminal/progress.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/study/statistics/study_statistics.h"
#include "mbk/study/statistics/study_statistics_text.h"
#include "mbk/study/workflow/bootstrap_units.h"

namespace mbk::app {
namespace {

enum class SummaryFormat { text, latex, csv, markdown };

constexpr auto word_table(SummaryFormat) {
  using enum SummaryFormat;
  return std::to_array<Word<SummaryFormat>>({{text, "text"}, {latex, "latex"}, {csv, "csv"}, {markdown, "markdown"}});
}

struct SummaryArguments : AnalysisArguments {
  std::optional<SummaryFormat> format;
  std::vector<std::string> outcomes;
  ComparingArguments comparing;
  std::optional<int> draws;
  std::uint64_t seed = 1;
  std::optional<int> raters;
  int sessions = 1, trials = 1;
  EngineArguments engine;
};

/// "patients=1-10,12": a name and the numbers of its people.
Result<statistics::PeopleGroup> group_of(const std::string& text) {
  const auto wrong = [&] {
    return bad_usage(fmt::format("{} is not a group", quoted(text)),
                     "write its name and participants: --group patients=1-10,12");
  };
  const std::size_t equal = text.find('=');
  if (equal == 0 || equal == std::string::npos) return wrong();
  statistics::PeopleGroup group{text.substr(0, equal), {}};
  std::string_view rest = std::string_view(text).substr(equal + 1);
  const auto number = [](std::string_view& from, std::int64_t& value) {
    const auto [end, code] = std::from_chars(from.data(), from.data() + from.size(), value);
    if (code != std::errc() || value < 1) return false;
    from.remove_prefix(static_cast<std::size_t>(end - from.data()));
    return true;
  };
  constexpr std::int64_t kMax = 1'000'000;
  while (true) {
    std::int64_t first = 0, last = 0;
    if (!number(rest, first)) return wrong();
    last = first;
    if (rest.starts_with('-')) {
      rest.remove_prefix(1);
      if (!number(rest, last) || last < first || last - first > kMax) return wrong();
    }
    for (std::int64_t one = first; one <= last; ++one) group.participants.push_back(one);
    if (rest.empty()) return group;
    if (!rest.starts_with(',')) return wrong();
    rest.remove_prefix(1);
  }
}

}  // namespace

Result<std::vector<statistics::PeopleGroup>> people_groups(const ComparingArguments& arguments) {
  std::vector<statistics::PeopleGroup> groups;
  for (const std::string& text : arguments.groups) {
    auto group = MBK_TRY(group_of(text));
    const auto same = std::ranges::find(groups, group.name, &statistics::PeopleGroup::name);
    if (same == groups.end()) {
      groups.push_back(std::move(group));
    } else {
      same->participants.insert(same->participants.end(), group.participants.begin(), group.participants.end());
    }
  }
  return groups;
}

Result<statistics::StatisticsOptions> statistics_options(const ComparingArguments& arguments) {
  statistics::StatisticsOptions options;
  options.groups = MBK_TRY(people_groups(arguments));
  if (arguments.compare.empty()) {
    if (!options.groups.empty())
      return bad_usage("--group is valid only with --compare group", "add --compare group, or omit --group");
    return options;
  }
  const auto by = value_of<statistics::ComparedBy>(arguments.compare.front());
  if (!by) {
    return bad_usage(fmt::format("--compare {} is unknown", quoted(arguments.compare.front())),
                     "pass --compare condition, group or session, followed by names unless all are to be compared");
  }
  if (*by != statistics::ComparedBy::group && !options.groups.empty()) {
    return bad_usage("--group is valid only with --compare group", "add --compare group, or omit --group");
  }
  options.comparing = {*by, {arguments.compare.begin() + 1, arguments.compare.end()}};
  return options;
}

void add_comparing_options(Command command, ComparingArguments& arguments) {
  command
      .add_option("--compare", arguments.compare,
                  "what to compare: condition, group or session, and optionally which of them (default: all)")
      .type_name("WHAT");
  command.add_option("--group", arguments.groups, "a group and its participants: patients=1-10,12")
      .type_name("NAME=N,N-N");
}
namespace {

std::string summary_text(const store::StudyList& list, const std::vector<store::OutcomeSummary>& outcomes,
                         const statistics::StudyStatistics& found, bool details) {
  const std::string text = study_head_text(list);
  if (!list.analysis) return text + "  no results yet; run 'mbk study measure'\n";
  if (outcomes.empty()) return text + "  no result is usable; 'mbk study list' shows the reasons\n";
  return text + statistics::outcomes_text(outcomes) + statistics::reliability_text(found, details) +
         statistics::comparison_text(found, details) + statistics::bootstrap_text(found) +
         statistics::notes_text(found.notes);
}

/// Resamples people, in this process or with --engine.
/// @returns  exit code of the command if not all resamples were computed
Result<std::optional<int>> resample(const SummaryArguments& arguments, const store::Store& study,
                                    statistics::StudyStatistics& found) {
  const workflow::Bootstrap bootstrap{statistics::people_tables(found), arguments.seed, *arguments.draws};
  workflow::Draws draws;
  if (arguments.engine.kind) {
    const auto carried = MBK_TRY(
        carry_out(arguments.engine, workflow::draws_request(bootstrap, study.folder()), arguments.output.quiet));
    if (carried.code) return carried.code;
    draws = MBK_TRY(workflow::draws_of(*carried.folder));
    MBK_TRY(batch::remove_job(*carried.folder, arguments.engine));
  } else {
    Progress progress(arguments.output.quiet, "resampling: ");
    draws = MBK_TRY(workflow::draws_here(bootstrap, [&](int done, int of) { progress.count(done, of); }));
  }
  statistics::add_bootstrap(found, bootstrap.tables, draws, arguments.seed);
  return std::nullopt;
}

/// As --format says, or else the ending of --out.
SummaryFormat format_of(const SummaryArguments& arguments) {
  using enum SummaryFormat;
  if (arguments.format) return *arguments.format;
  if (arguments.output.json || !arguments.output.to.file) return text;
  const auto ending = arguments.output.to.file->extension();
  return ending == ".tex" ? latex : ending == ".csv" ? csv : ending == ".md" ? markdown : text;
}

Result<void> check_format(const SummaryArguments& arguments) {
  if (arguments.output.json && arguments.format) {
    return bad_usage("--json and --format exclude each other", "omit one of them");
  }
  if (format_of(arguments) == SummaryFormat::text) return {};
  if (arguments.comparing.compare.empty() && arguments.comparing.groups.empty() && !arguments.draws) return {};
  return bad_usage("a table contains neither comparisons nor bootstrap intervals",
                   "omit --compare, --group and --bootstrap, or pass --format text or --json");
}

/// The summary in the format that was chosen.
std::string written(const SummaryArguments& arguments, const store::StudyList& list,
                    const std::vector<store::OutcomeSummary>& outcomes, const statistics::StudyStatistics& found) {
  switch (format_of(arguments)) {
    case SummaryFormat::latex:
      return statistics::summary_latex(list, outcomes, found);
    case SummaryFormat::csv:
      return statistics::summary_csv(list, outcomes, found);
    case SummaryFormat::markdown:
      return statistics::summary_markdown(list, outcomes, found);
    case SummaryFormat::text:
      break;
  }
  return arguments.output.json ? statistics::to_json(list, outcomes, found)
                               : summary_text(list, outcomes, found, !arguments.outcomes.empty());
}

Result<void> check_bootstrap(const SummaryArguments& arguments) {
  if (arguments.engine.kind && !arguments.draws) {
    return bad_usage("--engine is valid only with --bootstrap", "add --bootstrap 2000, or omit --engine");
  }
  return {};
}

int run_summary(const SummaryArguments& arguments) {
  if (auto ok = check_bootstrap(arguments); !ok) return report_error(ok.error());
  if (auto ok = check_format(arguments); !ok) return report_error(ok.error());
  auto options = statistics_options(arguments.comparing);
  if (!options) return report_error(options.error());
  options->outcomes = arguments.outcomes;
  if (arguments.raters) options->averaged = {*arguments.raters, arguments.sessions, arguments.trials};
  std::optional<store::Store> study;
  const auto list = listed_study(arguments, study);
  if (!list) return report_error(list.error());
  store::OutcomeColumns columns;
  if (list->analysis) {
    auto found = study->columns(list->analysis->number);
    if (!found) return report_error(found.error());
    columns = std::move(*found);
  }
  statistics::add_matrix_numbers(columns);
  auto found = statistics::study_statistics(columns, *options);
  if (!found) return report_error(found.error());
  if (arguments.draws) {
    const auto code = resample(arguments, *study, *found);
    if (!code) return report_error(code.error());
    if (*code) return **code;
  }
  if (!options->outcomes.empty()) {
    std::erase_if(columns.outcomes, [&](const store::OutcomeColumn& column) {
      return std::ranges::find(options->outcomes, column.name) == options->outcomes.end();
    });
  }
  const auto outcomes = store::summarise_outcomes(columns);
  const std::string text = written(arguments, *list, outcomes, *found);
  const auto ok = format_of(arguments) == SummaryFormat::text ? arguments.output.write(text, {study->folder()})
                                                              : arguments.output.to.write(text, {study->folder()});
  return ok ? kFine : report_error(ok.error());
}

}  // namespace

Action add_study_summary(Command group) {
  auto arguments = std::make_shared<SummaryArguments>();
  const Command command = group.add_command("summary", "summarise each outcome: mean, reliability, differences");
  command.footer(
      "Examples:\n"
      "  mbk study summary\n"
      "  mbk study summary --outcome K_xx\n"
      "      every form of ICC, limits of agreement, trials within a session, the mixed model\n"
      "  mbk study summary --compare condition relaxed tensed\n"
      "      within the same people if they have both conditions, otherwise between two groups of people\n"
      "  mbk study summary --compare group --group patients=1-10 --group controls=11-20\n"
      "  mbk study summary --compare session 1 2 --outcome K_xx K_yy\n"
      "      p-values are adjusted for the number of tests: choose the outcomes before looking at the results\n"
      "  mbk study summary --bootstrap 2000 --compare condition relaxed tensed\n"
      "      bootstrap intervals, which assume no distribution, from 2000 resamples of the people\n"
      "  mbk study summary --bootstrap 100000 --engine slurm\n"
      "      on the cluster; the intervals are identical\n"
      "  mbk study summary --outcome K_xx --raters 3 --trials 2\n"
      "      of the means of one, two and three raters with two trials each, if recordings name raters\n"
      "  mbk study summary --json --out summary.json\n"
      "  mbk study summary --outcome K_xx K_yy --out table_1.tex\n"
      "      a table for a paper: n, mean ± SD, ICC(A,1), SEM, MDC; or --format latex, csv, markdown\n\n"
      "The summary includes only usable results of recordings that are not excluded; the number of others\n"
      "is reported.");
  add_study_option(command, arguments->study);
  add_analysis_option(command, *arguments);
  const Option outcome = command
                             .add_option("--outcome", arguments->outcomes,
                                         "report only these outcomes, with all statistics (default: all)")
                             .type_name("NAME");
  const Option raters =
      command
          .add_option("--raters", arguments->raters,
                      "if the study has several raters: reliability, SEM and MDC of the mean of 1 to N raters")
          .type_name("N")
          .check(whole_number(1, 100))
          .needs(outcome);
  command.add_option("--sessions", arguments->sessions, "number of sessions averaged with --raters (default: 1)")
      .type_name("N")
      .check(whole_number(1, 100))
      .needs(raters);
  command
      .add_option("--trials", arguments->trials, "number of trials by each rater, averaged with --raters (default: 1)")
      .type_name("N")
      .check(whole_number(1, 1000))
      .needs(raters);
  add_comparing_options(command, arguments->comparing);
  const Option bootstrap =
      command
          .add_option("--bootstrap", arguments->draws,
                      "also compute bootstrap intervals of reliability and differences, from N resamples of the people")
          .type_name("N")
          .check(whole_number(1000, 100'000));
  command.add_option("--seed", arguments->seed, "random seed of the bootstrap (default: 1)")
      .type_name("N")
      .check(whole_number(0, std::numeric_limits<std::int64_t>::max()))
      .needs(bootstrap);
  add_choice(command, "--format", arguments->format,
             "text; latex (booktabs) or markdown: a table for a paper; csv: the same numbers with all digits (default: "
             "by the ending of --out: .tex, .md, .csv; otherwise text)");
  add_output_options(command, arguments->output, "mbk.study_summary/1");
  add_engine_options(command, arguments->engine);
  return [arguments] { return run_summary(*arguments); };
}

}  // namespace mbk::app
