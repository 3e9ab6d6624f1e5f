#include "apps/mbk/options/measure_options.h"

#include "apps/mbk/options/table_options.h"
#include "apps/mbk/options/threads_option.h"
#include "mbk/present/report/ranges_text.h"
#include "mbk/present/request/stage_tables.h"

namespace mbk::app {

void add_measure_options(Command command, MeasureArguments& arguments) {
  add_files_option(command, arguments.reading);
  add_options(command, request::measure_table(), arguments);
  command.add_flag("--pool", arguments.pool, "one fit over all FILEs; otherwise one result each and a summary")
      .group(request::kWindowGroup);
  add_ranges_flag(command);
  add_threads_option(command, arguments.threads, "files measured").group("Model");
}

void add_ranges_flag(Command command) {
  command
      .add_text_flag("--ranges", report::ranges_text,
                     "print the ranges that a hand or a joint must keep to, with where they come from")
      .group("Plausibility");
}

}  // namespace mbk::app
