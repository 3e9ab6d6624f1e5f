#include <CLI/CLI.hpp>
#include <string>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/terminal/last_words.h"

// Windows keeps no real time: what drives robots, and what shows that it does so in time, is left out there.
namespace mbk::app {
namespace {

Action add_left_out(Command app, const char* name, const std::string& what) {
  app.add_command(name, what + " (on Linux only)").cli().allow_extras();
  return [name] {
    return report_error({ErrorKind::usage, std::string("'mbk ") + name + "' is not there on Windows",
                         "use mbk on Linux, which can keep real time", ""});
  };
}

}  // namespace

Action add_run(Command app) {
  return add_left_out(app, "run", "run an experiment at 1 kHz: perturb, record, measure");
}

Action add_validate(Command app) {
  return add_left_out(app, "validate", "validate a method against known truth; prints a table");
}

Action add_reproduce(Command app) {
  return add_left_out(app, "reproduce", "reproduce the tables and figures of the thesis that mbk is based on");
}

Action add_work(Command app) {
  return add_left_out(app, "work", "work on a job started with --engine, or show its progress");
}

void LastWords::say() noexcept {}

}  // namespace mbk::app
