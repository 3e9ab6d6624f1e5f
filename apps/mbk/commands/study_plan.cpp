#include "mbk/study/statistics/study_plan.h"

#include <cmath>
#include <memory>

#include "apps/mbk/commands/study_commands.h"
#include "apps/mbk/commands/study_listing.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/study/statistics/study_statistics.h"

namespace mbk::app {
namespace {

struct PlanArguments : AnalysisArguments {
  std::string outcome;
  std::vector<std::string> conditions;
  std::optional<double> sd_people, sd_sessions, sd_trials;
  bool paired = false;
  int draws = 400;
  statistics::PlanGoal goal;
};

Result<statistics::Pilot> stated_pilot(const PlanArguments& arguments) {
  if (!arguments.outcome.empty() || !arguments.conditions.empty()) {
    return bad_usage("both a pilot and variances are given",
                     "pass either --outcome, or --sd-people and the other variances");
  }
  if (!arguments.sd_people || !arguments.sd_trials) {
    return bad_usage("not all variances are given",
                     "pass --sd-people and --sd-trials, and --sd-sessions if sessions differ");
  }
  statistics::Pilot pilot;
  pilot.variances = {std::pow(*arguments.sd_people, 2), std::pow(arguments.sd_sessions.value_or(0.0), 2),
                     std::pow(*arguments.sd_trials, 2)};
  return pilot;
}

Result<statistics::Pilot> measured_pilot(const PlanArguments& arguments) {
  if (arguments.outcome.empty()) {
    return bad_usage("no outcome is named", "pass --outcome K_xx, or the variances with --sd-people and --sd-trials");
  }
  std::optional<store::Store> study;
  const auto list = MBK_TRY(listed_study(arguments, study));
  if (!list.analysis) return bad_data("the study has no results", "run 'mbk study measure'");
  auto columns = MBK_TRY(study->columns(list.analysis->number));
  statistics::add_matrix_numbers(columns);
  std::vector<std::string> conditions = arguments.conditions;
  if (conditions.empty()) {
    if (columns.conditions.size() != 1) {
      std::string known;
      for (const std::string& one : columns.conditions) known += (known.empty() ? "" : ", ") + one;
      return bad_usage("the study has several conditions",
                       "choose one with --condition, or two to compare, of " + known);
    }
    conditions = columns.conditions;
  }
  return statistics::pilot_of(columns, arguments.outcome, conditions, arguments.draws, arguments.goal.seed);
}

int run_plan(const PlanArguments& arguments) {
  statistics::PlanGoal goal = arguments.goal;
  goal.pairing = arguments.paired ? reliability::Pairing::paired : reliability::Pairing::unpaired;
  if (arguments.conditions.size() == 2 && goal.max_sessions > 1) {
    return report_error({ErrorKind::usage, "how people differ in the change does not average out over sessions",
                         "plan one session where two conditions are compared", ""});
  }
  const bool stated = arguments.sd_people || arguments.sd_sessions || arguments.sd_trials;
  const auto pilot = stated ? stated_pilot(arguments) : measured_pilot(arguments);
  if (!pilot) return report_error(pilot.error());
  const auto plans = statistics::study_plans(*pilot, goal);
  if (!plans) return report_error(plans.error());
  const std::string text =
      arguments.output.json ? statistics::to_json(*pilot, goal, *plans) : statistics::plan_text(*pilot, goal, *plans);
  std::vector<std::filesystem::path> from;
  if (const auto study = stated ? std::nullopt : store::find_study(arguments.study.folder.value_or("."))) {
    from.push_back(*study);
  }
  if (auto ok = arguments.output.write(text, from); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_study_plan(Command group) {
  auto arguments = std::make_shared<PlanArguments>();
  const Command command = group.add_command("plan", "plan the number of people, sessions and trials of the next study");
  command.footer(
      "Examples:\n"
      "  mbk study plan --outcome K_xx --difference 50\n"
      "      two groups, with this study as the pilot; intervals show the uncertainty of the plan\n"
      "  mbk study plan --outcome K_xx --condition relaxed tensed --difference 50 --paired\n"
      "  mbk study plan --outcome K_xx --mdc 40 --sessions 3 --trials 6\n"
      "  mbk study plan --sd-people 60 --sd-sessions 15 --sd-trials 25 --difference 50 --simulate 4000\n"
      "      variances from elsewhere; power is also counted in simulated studies");
  add_study_option(command, arguments->study);
  add_analysis_option(command, *arguments);
  command.add_option("--outcome", arguments->outcome, "outcome of this study, which is the pilot").type_name("NAME");
  command.add_option("--condition", arguments->conditions, "condition of the pilot, or two to compare")
      .type_name("NAME")
      .expected(1, 2);
  command
      .add_option("--sd-people", arguments->sd_people,
                  "standard deviation between people, instead of a pilot, in the unit of the outcome")
      .check(not_negative());
  command
      .add_option("--sd-sessions", arguments->sd_sessions,
                  "standard deviation between sessions of one person (default: 0)")
      .check(not_negative());
  command.add_option("--sd-trials", arguments->sd_trials, "standard deviation between trials of one session")
      .check(not_negative());
  command
      .add_option("--difference", arguments->goal.difference,
                  "difference of two means to detect, in the unit of the outcome")
      .check(positive());
  command.add_flag("--paired", arguments->paired, "compare within the same people (default: between two groups)");
  command.add_option("--mdc", arguments->goal.change, "change of one person to detect, in the unit of the outcome")
      .check(positive());
  command.add_option("--power", arguments->goal.power, "statistical power (default: 0.8)").check(positive());
  command.add_option("--level", arguments->goal.level, "significance level (default: 0.05)").check(positive());
  command.add_option("--people", arguments->goal.people, "number of people in each group; reports the power")
      .type_name("N")
      .check(whole_number(2, 1000000));
  command.add_option("--sessions", arguments->goal.max_sessions, "maximum number of sessions (default: 1)")
      .type_name("N")
      .check(whole_number(1, 100));
  command.add_option("--trials", arguments->goal.max_trials, "maximum number of trials in each session (default: 10)")
      .type_name("N")
      .check(whole_number(1, 1000));
  command.add_option("--draws", arguments->draws, "number of resampled pilots for the intervals (default: 400)")
      .type_name("N")
      .check(whole_number(100, 100000));
  command
      .add_option("--simulate", arguments->goal.simulated_studies,
                  "number of simulated studies in which power is counted (default: 0)")
      .type_name("N")
      .check(whole_number(100, 1000000));
  command.add_option("--seed", arguments->goal.seed, "random seed (default: 1)")
      .type_name("N")
      .check(whole_number(0, 4294967295));
  add_output_options(command, arguments->output, "mbk.study_plan/1");
  return [arguments] { return run_plan(*arguments); };
}

}  // namespace mbk::app
