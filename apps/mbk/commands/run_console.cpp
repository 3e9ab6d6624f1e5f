#include "apps/mbk/commands/run_console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "apps/mbk/options/report_file.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/experiment/console/page.h"
#include "mbk/present/report/html.h"
#include "mbk/present/report/text.h"

namespace mbk::app {

void add_console_options(Command command, ConsoleArguments& arguments) {
  command.add_flag_callback(
      "--console", [&arguments] { arguments.requested = true; },
      "serve pages for watching and stopping the run, on this machine only (default: at a terminal)");
  command.add_flag_callback(
      "--no-console", [&arguments] { arguments.requested = false; }, "do not serve the console");
  command.add_option("--port", arguments.port, "port of the console (default: any free port)")
      .type_name("N")
      .check(whole_number(0, 65535));
  command.add_flag("--wait", arguments.wait, "start each trial from the console; nothing moves before");
  command
      .add_option("--texts", arguments.texts,
                  "texts of the participant's page: en, de, or your own .toml file (default: en)")
      .type_name("TEXTS")
      .check(not_empty());
}

std::string time_text(const realtime::CycleRecord& record) {
  return fmt::format("median {:.1f} µs, p99.9 {:.1f} µs, worst {:.1f} µs", 1e-3 * record.quantile(0.5),
                     1e-3 * record.quantile(0.999), 1e-3 * static_cast<double>(record.worst()));
}

Result<RunConsole> RunConsole::open(const ConsoleArguments& arguments, const session::Experiment& experiment,
                                    session::LoopFlags& flags) {
  RunConsole run;
  if (arguments.wait && arguments.requested == false) {
    return bad_usage("--wait waits for the console, which --no-console omits", "omit one of the two");
  }
  if (!arguments.texts.empty() && arguments.requested == false) {
    return bad_usage("--texts applies to the console, which --no-console omits", "omit one of the two");
  }
  std::vector<std::string> names;
  for (const session::Plan& plan : experiment.plans) names.push_back(plan.trial.name);
  const auto texts = MBK_TRY(console::find_texts(arguments.texts.empty() ? "en" : arguments.texts, names));
  const bool terminal = isatty(STDIN_FILENO) == 1 && isatty(STDERR_FILENO) == 1 && console::operator_page();
  if (!arguments.requested.value_or(arguments.wait || terminal)) return run;
  MBK_TRY(console::operator_page());
  run.console_ = MBK_TRY(console::Console::open(arguments.port, experiment.plans, flags,
                                                [](const std::string& line) { say("mbk: console: {}\n", line); }));
  run.console_->show_texts(texts);
  run.page_ = std::make_unique<console::PageOperator>(
      *run.console_, arguments.wait, [](const std::string& warning) { say("mbk: warning: {}\n", warning); });
  say("console:              {}\nparticipant's screen: {}\nonly to watch:        {}\n", run.console_->address(),
      run.console_->participant_address(), run.console_->viewing_address());
  return run;
}

std::string RunConsole::times_text() const {
  if (!console_) return {};
  const auto with = console_->times(true), without = console_->times(false);
  if (with.lateness.count() == 0 || without.lateness.count() == 0) return {};
  std::string text;
  for (const auto& [name, times] : {std::pair{"with pages open", with}, {"without", without}}) {
    text += fmt::format("  {}, {} ticks: compute {}; lateness {}\n", name, times.lateness.count(),
                        time_text(times.compute), time_text(times.lateness));
  }
  return text;
}

Result<Measurement> RunConsole::measured(const Recording& recording) const {
  if (!console_) return session::measure_recording(recording);
  auto examined = measurement::examine({&recording, 1}, {});
  if (!examined) {
    console_->show_report("", examined.error().line());
    return tl::unexpected(examined.error());
  }
  std::optional<Diagnostics> diagnostics;
  if (!examined->diagnostics.empty()) diagnostics = std::move(examined->diagnostics.front());
  const std::string typed = fmt::format("mbk measure {}", page_->recording().string());
  auto html = report::page(report_json(typed, "", {facts_of(recording, examined->measured.identification)},
                                       {examined->measured}, {diagnostics}, nullptr),
                           {report::measurement_text(examined->measured), {}});
  console_->show_report(html ? std::move(*html) : "", html ? "" : html.error().line());
  return std::move(examined->measured);
}

Result<void> RunConsole::end() const {
  if (!console_) return {};
  if (console_->status().viewers > 0) {
    say("the console stays open until its pages are closed; Ctrl-C also ends it\n");
    console_->wait_until_left();
  }
  return page_->keep_notes();
}

}  // namespace mbk::app
