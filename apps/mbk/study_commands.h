#pragma once

#include "apps/mbk/commands.h"

/// The commands of `mbk study`.
namespace mbk::app {

Action add_study_init(CLI::App& group);
Action add_study_defaults(CLI::App& group);
Action add_study_add(CLI::App& group);
Action add_study_import(CLI::App& group);
Action add_study_list(CLI::App& group);
Action add_study_show(CLI::App& group);
Action add_study_measure(CLI::App& group);
Action add_study_status(CLI::App& group);
Action add_study_exclude(CLI::App& group);
Action add_study_summary(CLI::App& group);
Action add_study_plan(CLI::App& group);
Action add_study_report(CLI::App& group);
Action add_study_export(CLI::App& group);
Action add_study_forget(CLI::App& group);
Action add_study_check(CLI::App& group);
Action add_study_log(CLI::App& group);
Action add_study_backup(CLI::App& group);

}  // namespace mbk::app
