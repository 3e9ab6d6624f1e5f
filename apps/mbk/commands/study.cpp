#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/study_commands.h"

namespace mbk::app {

Action add_study(Command app) {
  const Command group =
      app.add_command("study", "manage a study of many participants and trials: store, measure, summarise, export");
  group.footer(
      "Examples:\n"
      "  mbk study init arms --title \"Stiffness at rest\"\n"
      "      creates a folder for a database and the recordings; then, in this folder or with --study arms:\n"
      "  mbk study add p07_relaxed.h5 --participant 7 --session 2 --condition relaxed\n"
      "  mbk study import 'recordings of mbk run'/*.h5\n"
      "  mbk study measure\n"
      "      measures only recordings that are new or whose options changed\n"
      "  mbk study summary\n"
      "  mbk study check\n\n"
      "Participants are numbers. File names are not stored, and a recording whose metadata name a person\n"
      "is rejected. Every change of a study is recorded in its log ('mbk study log').");
  group.require_subcommand();
  const Actions actions = {{"init", add_study_init(group)},       {"defaults", add_study_defaults(group)},
                           {"add", add_study_add(group)},         {"import", add_study_import(group)},
                           {"list", add_study_list(group)},       {"show", add_study_show(group)},
                           {"measure", add_study_measure(group)}, {"status", add_study_status(group)},
                           {"exclude", add_study_exclude(group)}, {"summary", add_study_summary(group)},
                           {"plan", add_study_plan(group)},       {"report", add_study_report(group)},
                           {"export", add_study_export(group)},   {"forget", add_study_forget(group)},
                           {"check", add_study_check(group)},     {"log", add_study_log(group)},
                           {"backup", add_study_backup(group)}};
  return [group, actions] { return run_chosen(group, actions); };
}

}  // namespace mbk::app
