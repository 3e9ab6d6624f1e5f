#include "apps/mbk/options/measure_options.h"

#include "apps/mbk/options/table_options.h"
#include "apps/mbk/options/threads_option.h"
#include "mbk/present/report/ranges_text.h"
#include "mbk/present/request/stage_tables.h"

namespace mbk::app {

void add_measure_options(Command command, MeasureArguments& arguments) {
  add_files_option(command, arguments.reading);
  add_main_options(command, request::measure_table(), arguments, kMainMeasureOptions);
  add_options(command, request::measure_table(), arguments);
  command
      .add_flag("--pool", arguments.pool,
                "fit one model to all FILEs together (default: one result for each FILE, and a summary)")
      .group(request::kWindowGroup);
  add_ranges_flag(command);
  add_threads_option(command, arguments.threads, "number of files measured in parallel").group("Model");
}

void add_ranges_flag(Command command) {
  command
      .add_text_flag("--ranges", report::ranges_text,
                     "print the plausible ranges for a hand and for a joint, with their sources, and exit")
      .group("Plausibility");
}

}  // namespace mbk::app
