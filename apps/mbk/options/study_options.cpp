#include "apps/mbk/options/study_options.h"

#include "apps/mbk/options/table_options.h"
#include "apps/mbk/options/word_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"

namespace mbk::app {
namespace {

void say_waiting() {
  say("mbk: waiting for another process that is using the study, for at most half a minute\n");
}

}  // namespace

void add_study_option(Command command, StudyArguments& arguments) {
  command
      .add_option("--study", arguments.folder,
                  "folder of the study (default: the study that contains the current folder)")
      .type_name("FOLDER")
      .check(not_empty());
}

void add_choice_of_role(Command command, StudyArguments& arguments) {
  add_choice(command, "--role", arguments.role, "your role, recorded in the log; never a name (default: analyst)");
}

void add_study_and_role(Command command, StudyArguments& arguments) {
  add_study_option(command, arguments);
  add_choice_of_role(command, arguments);
}

Result<store::Store> open_study(const StudyArguments& arguments) {
  if (arguments.folder) return store::Store::open(*arguments.folder, say_waiting);
  const auto folder = store::find_study(".");
  if (!folder) {
    return bad_usage("neither this folder nor one above it is a study",
                     "name a study with --study FOLDER, or create one with 'mbk study init FOLDER'");
  }
  return store::Store::open(*folder, say_waiting);
}

void add_measuring_options(Command command, request::MeasureRequest& measuring) {
  add_main_options(command, workflow::measuring_table(), measuring, kMainMeasureOptions);
  add_options(command, workflow::measuring_table(), measuring);
  add_ranges_flag(command);
}

}  // namespace mbk::app
