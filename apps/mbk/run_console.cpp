#include "apps/mbk/run_console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "apps/mbk/messages.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/report_file.h"
#include "mbk/experiment/console/page.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/experiment/protocol/personal_data.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/present/report/html.h"

namespace mbk::app {

using console::Action;
using console::Question;
using protocol::Trial;

void add_console_options(CLI::App& command, ConsoleArguments& arguments) {
  command.add_flag_callback(
      "--console", [&arguments] { arguments.wanted = true; },
      "serve a page to watch and stop it, on this machine only; the default at a terminal");
  command.add_flag_callback(
      "--no-console", [&arguments] { arguments.wanted = false; }, "no such page");
  command.add_option("--port", arguments.port, "of the console, instead of any that is free")
      ->type_name("N")
      ->check(whole_number(0, 65535));
  command.add_flag("--wait", arguments.wait, "the console begins each trial; nothing moves before");
}

measurement::Options measurement_options_of(const Trial& trial) {
  measurement::Options options;
  options.identify.handle_mass = trial.handle_mass;
  if (!std::holds_alternative<control::PositionMode>(trial.control)) {
    options.identify.method = Method::instrumental_variables;  // the person answers what least squares takes for noise
  }
  return options;
}

std::string time_text(const realtime::CycleRecord& record) {
  return fmt::format("median {:.1f} µs, p99.9 {:.1f} µs, worst {:.1f} µs", 1e-3 * record.quantile(0.5),
                     1e-3 * record.quantile(0.999), 1e-3 * static_cast<double>(record.worst()));
}

Result<RunConsole> RunConsole::open(const ConsoleArguments& arguments, const std::vector<Trial>& trials,
                                    session::Signals& signals) {
  RunConsole run;
  if (arguments.wait && arguments.wanted == false) {
    return bad_usage("--wait waits for the console, which --no-console leaves away", "leave one of the two away");
  }
  const bool terminal = isatty(STDIN_FILENO) == 1 && isatty(STDERR_FILENO) == 1 && console::operator_page();
  if (!arguments.wanted.value_or(arguments.wait || terminal)) return run;
  if (auto page = console::operator_page(); !page) return tl::unexpected(page.error());
  auto opened = console::Console::open(arguments.port, trials, signals,
                                       [](const std::string& line) { say("mbk: console: {}\n", line); });
  if (!opened) return tl::unexpected(opened.error());
  run.console_ = std::move(*opened);
  run.wait_ = arguments.wait;
  say("console:              {}\nparticipant's screen: {}\nonly to watch:        {}\n", run.console_->address(),
      run.console_->participant_address(), run.console_->viewing_address());
  return run;
}

void RunConsole::show_robot(const safety::MotorsOff& motors) {
  if (!console_) return;
  using State = safety::MotorsOff::State;
  console::RobotStatus status;
  status.link = motors.state != State::cannot_say;
  if (motors.state == State::confirmed) status.motors = device::Motors::off;
  if (motors.state == State::confirmed || motors.state == State::missing) {
    status.confirmed_off = motors.state == State::confirmed;
  }
  status.sentence = safety::sentence(motors);
  console_->show_robot(status);
}

std::function<void(const session::IdleState&)> RunConsole::watching(session::Session& session) {
  const safety::Gate* const gate = session.gate();
  const bool missing = gate != nullptr && gate->motors().state == safety::MotorsOff::State::missing;
  return [&session, console = console_.get(), missing](const session::IdleState& seen) {
    session.see_idle(seen);
    if (console == nullptr) return;
    console::RobotStatus status;
    status.link = seen.link;
    status.stop_button = seen.stop_button;
    status.fault = seen.fault;
    status.motors = seen.motors;
    if (seen.confirmed_off) {
      status.confirmed_off = true;
    } else if (missing || seen.motors == device::Motors::on) {
      status.confirmed_off = false;
    }
    console->show_robot(status);
  };
}

bool RunConsole::may_begin(session::Session& session, const Trial& first) {
  if (!console_ || !wait_) return true;
  std::unique_ptr<device::Device> robot;
  std::optional<session::IdleWatch> idle;
  if (!first.device.simulated()) {
    if (auto made = protocol::make_device(first)) robot = std::move(*made);
    if (robot && robot->start()) idle.emplace(*robot, watching(session));
  }
  while (true) {
    const Action decided = console_->ask(Question::begin);
    if (decided == Action::start) return true;
    if (decided == Action::abort) return false;
    if (decided != Action::reset) continue;
    if (auto ok = session.reset(); !ok) console_->say(ok.error().line());
  }
}

Result<void> RunConsole::begin(std::size_t index, const Trial& trial, const device::Facts& facts,
                               const std::filesystem::path& target) {
  if (!console_) return {};
  const auto plan = session::make_plan(trial);
  if (!plan) return tl::unexpected(plan.error());
  console_->begin(index, session::header_of(trial, facts, plan->schedule), measurement_options_of(trial), target,
                  plan->sequence.duration(0.0));
  return {};
}

void RunConsole::watch(std::span<const journal::Tick> ticks) {
  if (console_) console_->watch(ticks);
}

std::string RunConsole::finish(const session::TrialOutcome& outcome) {
  last_ = outcome.recording;
  if (!console_) return {};
  console_->finish(outcome);
  const auto with = console_->times(true), without = console_->times(false);
  if (with.lateness.count() == 0 || without.lateness.count() == 0) return {};
  std::string text;
  for (const auto& [name, times] : {std::pair{"with pages open", with}, {"without", without}}) {
    text += fmt::format("  {}, {} ticks: compute {}; lateness {}\n", name, times.lateness.count(),
                        time_text(times.compute), time_text(times.lateness));
  }
  return text;
}

Result<Measurement> RunConsole::measured(const Recording& recording, const measurement::Options& options) {
  if (!console_) return measurement::measure({&recording, 1}, options);
  auto examined = measurement::examine({&recording, 1}, options);
  if (!examined) {
    console_->show_report("", examined.error().line());
    return tl::unexpected(examined.error());
  }
  std::optional<Diagnostics> diagnostics;
  if (!examined->diagnostics.empty()) diagnostics = std::move(examined->diagnostics.front());
  const std::string typed = fmt::format("mbk measure {}", last_.string());
  auto html = report::page(report_json(typed, "", {recording}, {examined->measured}, {diagnostics}, std::nullopt));
  console_->show_report(html ? std::move(*html) : "", html ? "" : html.error().line());
  return std::move(examined->measured);
}

Result<void> RunConsole::keep_notes() {
  if (!console_ || last_.empty()) return {};
  const auto notes = console_->take_notes();
  for (const std::string& note : notes) {
    const std::string warning = protocol::personal_warning("the note", note, false);
    if (warning.empty()) continue;
    say("mbk: warning: {}\n", warning);
    console_->say(warning);
  }
  return notes.empty() ? Result<void>{} : session::annotate(last_, notes);
}

bool RunConsole::decides(bool doubtful) const {
  return console_ && (wait_ || (doubtful && console_->status().controlled));
}

AfterTrial RunConsole::after_trial(session::Session& session, bool stopped) {
  Question question = stopped ? Question::reset : Question::after;
  while (true) {
    switch (console_->ask(question)) {
      case Action::repeat:
        return AfterTrial::repeat;
      case Action::next:
        return AfterTrial::next;
      case Action::abort:
        return AfterTrial::end;
      case Action::note:
        if (auto ok = keep_notes(); !ok) console_->say(ok.error().line());
        break;
      case Action::reset:
        if (auto ok = session.reset(); !ok) {
          console_->say(ok.error().line());
        } else {
          question = Question::after;
        }
        break;
      default:
        break;
    }
  }
}

Result<void> RunConsole::end() {
  if (!console_) return {};
  if (console_->status().viewers > 0) {
    say("the console stays until its pages are closed; Ctrl-C ends it too\n");
    console_->wait_until_left();
  }
  return keep_notes();
}

}  // namespace mbk::app
