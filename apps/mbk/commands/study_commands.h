#pragma once

#include "apps/mbk/commands/commands.h"

/// The commands of `mbk study`.
namespace mbk::app {

Action add_study_init(Command group);
Action add_study_defaults(Command group);
Action add_study_add(Command group);
Action add_study_import(Command group);
Action add_study_list(Command group);
Action add_study_show(Command group);
Action add_study_measure(Command group);
Action add_study_status(Command group);
Action add_study_exclude(Command group);
Action add_study_summary(Command group);
Action add_study_plan(Command group);
Action add_study_report(Command group);
Action add_study_export(Command group);
Action add_study_forget(Command group);
Action add_study_check(Command group);
Action add_study_log(Command group);
Action add_study_backup(Command group);

}  // namespace mbk::app
