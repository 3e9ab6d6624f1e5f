#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <limits>
#include <memory>
#include <optional>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/commands/plan_text.h"
#include "apps/mbk/commands/run_console.h"
#include "apps/mbk/options/output.h"
#include "apps/mbk/options/readers_option.h"
#include "apps/mbk/terminal/last_words.h"
#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/stop_keys.h"
#include "apps/mbk/terminal/stop_signals.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/experiment/protocol/personal_data.h"
#include "mbk/experiment/session/conduct.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/session.h"
#include "mbk/present/report/text.h"
#include "mbk/simulate/laboratory/named_scenario.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;
using protocol::Trial;
using session::Next;
using session::Session;

constexpr int kSafetyStop = 5;

struct RunArguments {
  std::string experiment;
  std::vector<std::string> trials;
  fs::path out;
  std::optional<std::uint64_t> seed;
  std::optional<int> person;
  std::optional<double> speed;
  std::optional<Readers> readers;
  bool as_fast_as_possible = false, dry_run = false, measure = true, quiet = false;
  ConsoleArguments console;
};

Result<std::vector<Trial>> trials_of(const RunArguments& arguments) {
  const auto text = MBK_TRY(laboratory::read_scenario_text(arguments.experiment));
  auto trials = MBK_TRY(protocol::read_experiment(text.text, text.file, laboratory::read_simulation));
  std::vector<Trial> chosen;
  for (const std::string& name : arguments.trials) {
    const auto found = std::ranges::find(trials, name, &Trial::name);
    if (found == trials.end()) {
      return bad_usage(fmt::format("the experiment has no trial '{}'", name),
                       "use the name of a [[trial]] in the file");
    }
    chosen.push_back(*found);
  }
  if (chosen.empty()) chosen = std::move(trials);
  for (Trial& trial : chosen) {
    if (arguments.seed) trial.seed = *arguments.seed;
    if (arguments.person) trial.person.number = *arguments.person;
    if (arguments.readers) trial.readers = *arguments.readers;
  }
  return chosen;
}

/// One line on standard error: rewritten in place at a terminal, otherwise once a second.
class StatusLine {
 public:
  StatusLine(std::string_view trial, bool quiet)
      : trial_(trial), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

  void show(std::span<const journal::Tick> ticks) {
    const journal::Tick& tick = ticks.back();
    const auto now = std::chrono::steady_clock::now();
    if (quiet_ || now < next_) return;
    next_ = now + std::chrono::milliseconds(terminal_ ? 100 : 1000);
    const auto phase = static_cast<control::Phase>(tick.phase);
    const std::string line = fmt::format("{}{:6.1f} s  {}  |F| {:4.1f} N  torque {:+.2f} {:+.2f} N·m",
                                         trial_.empty() ? "" : trial_ + ": ", tick.time, word_of(phase),
                                         std::hypot(tick.force[0], tick.force[1]), tick.torque[0], tick.torque[1]);
    say("{}{}{}", terminal_ ? "\r\033[K" : "", line, terminal_ ? "" : "\n");
    shown_ = true;
  }

  ~StatusLine() {
    if (shown_ && terminal_) say_text("\r\033[K");
  }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

 private:
  std::string trial_;
  bool quiet_, terminal_, shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

std::string outcome_text(const session::TrialOutcome& outcome, const session::Pace& pace) {
  const std::string file = (outcome.unrecorded ? outcome.journal : outcome.recording).string();
  std::string text = fmt::format("{}: {}", file, outcome.ended);
  if (!outcome.ending.detail.empty()) text += ": " + outcome.ending.detail;
  text += "\n  motors: " + safety::sentence(outcome.motors);
  for (const std::string& note : outcome.notes) {
    if (outcome.unrecorded) text += "\n  note that is not in a recording: " + note;
  }
  text += fmt::format("\n  {} ticks, {} dropped; compute per tick: {}\n", outcome.times.ticks, outcome.ending.dropped,
                      time_text(outcome.times.compute));
  if (!pace.virtual_clock) {
    text += fmt::format("  lateness: {}; {} ticks missed\n", time_text(outcome.times.lateness), outcome.times.missed);
    text += fmt::format("  time between commands: {}\n", time_text(outcome.times.interval));
    if (outcome.times.early > 0) {
      text += fmt::format("  ! the clock woke the loop too early {} times; it waited again\n", outcome.times.early);
    }
    if (!outcome.setup.refused.empty()) text += fmt::format("  {}\n", outcome.setup.refused);
  }
  return text;
}

/// Damage of the journal, which is then kept.
std::string damage_text(const session::TrialOutcome& outcome) {
  std::string text;
  for (const std::string& sentence : outcome.damage.sentences()) text += fmt::format("  ! {}\n", sentence);
  if (!text.empty()) text += fmt::format("  the journal is kept: {}\n", outcome.journal.string());
  return text;
}

int dry_run(const session::Experiment& experiment, const std::string& file) {
  for (const session::Plan& plan : experiment.plans) {
    const auto rehearsal = session::rehearse(plan);
    if (!rehearsal) return report_error(rehearsal.error().in(file));
    if (auto ok = print_text(plan_text(plan, *rehearsal)); !ok) return report_error(ok.error());
    if (rehearsal->trip.reason != safety::Reason::none) return kSafetyStop;
  }
  return kFine;
}

/// For a real robot: limits that are weaker than by default, and facts that are assumed. Each is listed once.
std::vector<std::string> robot_warnings(const session::Experiment& experiment) {
  std::vector<std::string> all;
  for (const session::Plan& plan : experiment.plans) {
    if (plan.trial.device.simulated()) continue;
    std::vector<std::string> here = safety::weakened(plan.limits);
    if (std::string assumed = protocol::assumptions_text(plan.trial); !assumed.empty()) here.push_back(assumed);
    for (std::string& one : here) {
      if (std::ranges::count(all, one) == 0) all.push_back(std::move(one));
    }
  }
  return all;
}

/// At a terminal. Discards what was typed before the question.
bool ask(const char* question, const session::LoopFlags& flags) {
  tcflush(STDIN_FILENO, TCIFLUSH);
  say("{} [y/N] ", question);
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!flags.end_session) {
    constexpr int kWait = 100;  // [ms]
    if (poll(&input, 1, kWait) <= 0) continue;
    std::array<char, 256> line{};
    const ssize_t came = ::read(STDIN_FILENO, line.data(), line.size());
    if (came < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    return came > 0 && (line[0] == 'y' || line[0] == 'Y');
  }
  return false;
}

/// Messages that standard error did not accept, for standard output and the recording.
std::string lost_messages_text(const LostMessages& lost) {
  if (lost.count == 0) return {};
  return fmt::format("{} message{} of mbk to standard error lost: {}", lost.count, lost.count == 1 ? "" : "s",
                     lost.why);
}

/// The alarm that the motors are not confirmed off.
std::string alarm(const safety::MotorsOff& motors) {
  constexpr std::size_t kAlarmWidth = 78;  // any terminal's
  const std::string line(kAlarmWidth, '!');
  return fmt::format(
      "\a\n{0}\n!!  MOTORS NOT CONFIRMED OFF\n!!  Press the hardware stop button: cut the motors' power. Let nobody "
      "touch the robot.\n{0}\n{1}\n\n",
      line, report::wrapped("The motors are " + safety::sentence(motors) + ".", kAlarmWidth));
}

/// Exit code of the session: that of its worst event.
int code_of(const session::Conclusion& conclusion) {
  const int code = conclusion.failure ? report_error(*conclusion.failure) : kFine;
  if (conclusion.motors.state == safety::MotorsOff::State::missing) return kMotorsNotOff;
  return conclusion.trip.reason != safety::Reason::none ? kSafetyStop : code;
}

/// Signals and keys that stop a running trial, and a status line beside the page.
class TrialWatcher : public session::Watcher {
 public:
  TrialWatcher(std::unique_ptr<session::Watcher> page, const session::Attempt& attempt, session::LoopFlags& flags,
               bool quiet)
      : page_(std::move(page)),
        last_words_(attempt.robot, session::journal_of(attempt.target)),
        keys_(flags),
        line_(attempt.plan.trial.name, quiet) {}

  void watch(std::span<const journal::Tick> ticks) override {
    line_.show(ticks);
    if (page_) page_->watch(ticks);
  }

 private:
  std::unique_ptr<session::Watcher> page_;
  const StopSignals::Trial running_;
  const LastWords last_words_;
  const StopKeys keys_;
  StatusLine line_;
};

/// The operator at the terminal, and at the page if there is one, which then makes the decisions that are its own.
class TerminalOperator : public session::Operator {
 public:
  /// @param warnings  printed before the first trial
  TerminalOperator(const RunConsole& console, session::LoopFlags& flags, const session::Pace& pace, bool quiet,
                   std::vector<std::string> warnings)
      : page_(console.page()),
        console_(console),
        flags_(flags),
        pace_(pace),
        quiet_(quiet),
        warnings_(std::move(warnings)) {}

  std::unique_ptr<session::Watcher> begin(const session::Attempt& attempt) override {
    for (const std::string& warning : std::exchange(warnings_, {})) say("mbk: warning: {}\n", warning);
    return std::make_unique<TrialWatcher>(page_ != nullptr ? page_->begin(attempt) : nullptr, attempt, flags_, quiet_);
  }

  void motors(const safety::MotorsOff& motors) override {
    using State = safety::MotorsOff::State;
    if (motors.state == State::missing) say("{}", alarm(motors));
    if (motors.state == State::waiting) say("mbk: the robot's driver returned after {:.2f} s\n", motors.after);
    if (page_ != nullptr) page_->motors(motors);
  }

  void idle(const session::IdleState& seen) override {
    if (page_ != nullptr) page_->idle(seen);
  }

  void given_up(const session::TrialOutcome& outcome) override {
    motors(outcome.motors);
    if (page_ != nullptr) page_->recorded(outcome);
    const auto written = print_text(outcome_text(outcome, pace_));
    if (!written) report_error(written.error());
    if (outcome.unrecorded) report_error(*outcome.unrecorded);
    say("mbk: the robot's driver still does not return. Press Ctrl-C or send SIGTERM to end mbk with exit code {}.\n",
        kMotorsNotOff);
  }

  std::vector<std::string> notes() override {
    std::vector<std::string> notes = page_ != nullptr ? page_->notes() : std::vector<std::string>();
    lost_ = lost_messages_text(take_lost_messages());
    if (!lost_.empty()) notes.push_back(lost_);
    return notes;
  }

  void recorded(const session::TrialOutcome& outcome) override {
    if (page_ != nullptr) page_->recorded(outcome);
    text_ = outcome_text(outcome, pace_) + console_.times_text();
    if (!lost_.empty()) text_ += fmt::format("  {}\n", lost_);
    text_ += damage_text(outcome);
  }

  Result<void> judged(const session::Performed& performed) override {
    if (const auto& measured = performed.measured) {
      text_ += *measured ? report::measurement_text(**measured)
                         : fmt::format("not measured: {}\n", measured->error().line());
    }
    if (performed.attempt.plan.schedule.reaches() != nullptr && !performed.outcome.unrecorded) {
      text_ +=
          fmt::format("  reaches: 'mbk explore {}' estimates the stiffness\n", performed.outcome.recording.string());
    }
    const auto written = print_text(text_);
    if (page_ != nullptr) {
      MBK_TRY(page_->judged(performed));
    }
    return written;
  }

  session::Next next(Session& session, const session::Performed& performed) override {
    if (page_ != nullptr && page_->decides(performed)) return page_->next(session, performed);
    const bool terminal = isatty(STDIN_FILENO) == 1;
    if (performed.stopped()) return terminal ? after_stop(session) : Next::end;
    if (!performed.poor()) return Next::go_on;
    if (terminal) return ask("The data are poor. Repeat the trial?", flags_) ? Next::repeat : Next::go_on;
    say("mbk: {}: the data are poor; consider repeating the trial\n", performed.attempt.target.string());
    return Next::go_on;
  }

 private:
  Next after_stop(Session& session) {
    while (ask("Cause cleared? Reset and repeat the trial?", flags_)) {
      const auto reset = session.reset();
      if (reset) return Next::repeat;
      report_error(reset.error());
    }
    return Next::end;
  }

  console::PageOperator* page_;
  const RunConsole& console_;
  session::LoopFlags& flags_;
  session::Pace pace_;
  bool quiet_;
  std::vector<std::string> warnings_;
  std::string text_, lost_;  // of the trial that is being judged; messages that were lost while it ran
};

/// @returns  the exit code, unless a signal ended the session outside of a trial
int conduct_experiment(Session& session, const session::Experiment& experiment, const session::Pace& pace,
                       const RunArguments& arguments) {
  const auto console = RunConsole::open(arguments.console, experiment, session.flags());
  if (!console) return report_error(console.error());
  if (auto* const page = console->page(); page != nullptr && !page->may_begin(session, experiment)) return kFine;
  TerminalOperator conductor(*console, session.flags(), pace, arguments.quiet, robot_warnings(experiment));
  session::Measure measure;
  if (arguments.measure) {
    measure = [&](const Recording& recording) { return console->measured(recording); };
  }
  const int code = code_of(session::conduct(experiment, session, conductor, measure));
  if (auto ok = console->end(); !ok) {
    const int lost = report_error(ok.error());
    return code == kFine ? lost : code;  // motors that are not off are worse than lost notes
  }
  return code;
}

int run(const RunArguments& arguments) {
  const auto trials = trials_of(arguments);
  if (!trials) return report_error(trials.error());
  for (const std::string& warning : protocol::personal_warnings(*trials)) {
    say("mbk: {}: warning: {}\n", arguments.experiment, warning);
  }
  session::Pace pace;
  pace.virtual_clock = arguments.as_fast_as_possible || arguments.speed.has_value();
  pace.speed = arguments.speed.value_or(0.0);
  const auto experiment = session::plan_experiment(*trials, arguments.out, arguments.experiment);
  if (!experiment) return report_error(experiment.error());
  if (arguments.dry_run) return dry_run(*experiment, arguments.experiment);
  Session session(pace);
  int code = kFine, ended_by = 0;
  {
    const StopSignals signals(session.flags());
    const BackgroundMessages messages;
    code = conduct_experiment(session, *experiment, pace, arguments);
    ended_by = signals.ended_by();
  }
  if (ended_by != 0 && code == kFine) end_by(ended_by);
  return code;
}

}  // namespace

Action add_run(Command app) {
  auto arguments = std::make_shared<RunArguments>();
  const Command command = app.add_command("run", "run an experiment at 1 kHz: perturb, record, measure");
  command.footer(
      "Examples:\n"
      "  mbk run relaxed_sinusoidal --out relaxed.h5\n"
      "      a simulated robot and participant, in real time; needs no hardware\n"
      "  mbk run mine.toml --dry-run\n"
      "      schedule, peaks, duration and limits; run it before a participant sits down\n"
      "  mbk run mine.toml --participant 7 --out p07.h5\n"
      "      every [[trial]] of the file in turn, into p07_NAME.h5\n"
      "  mbk run relaxed_sinusoidal --fast --out relaxed.h5\n"
      "      the same on a virtual clock, as fast as possible; --speed 20: twenty times real time\n"
      "  mbk run mine.toml --wait\n"
      "      nothing moves until the operator starts it in the console, a page whose address is printed\n\n"
      "The space bar and Ctrl-C stop the robot; e ends a trial early. Data are first written to\n"
      "NAME.h5.journal; if the program or the computer crashed, 'mbk recover' makes a recording of it.\n"
      "The gate limits force, torque, speed and position in software; it is not a certified safety\n"
      "function. With people, a stop button that cuts the motors' power remains necessary\n"
      "(docs/guide/run.md).\n\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 bad or unreadable data, or lost ticks, 4 computed but not\n"
      "usable, 5 safety stop, 7 the robot did not confirm that its motors are off: cut their power.");
  command.add_option("EXPERIMENT", arguments->experiment, "a .toml file, or the name of a built-in experiment")
      .required()
      .check(suggests(laboratory::ready_scenario_names()));
  command.add_option("--out", arguments->out, "recording to write (default: NAME.h5); several trials get suffixes")
      .type_name("REC")
      .check(not_empty());
  command.add_option("--trial", arguments->trials, "run only this [[trial]] of the file; may be repeated")
      .type_name("NAME");
  command.add_option("--seed", arguments->seed, "random seed; overrides the experiment file")
      .type_name("N")
      .check(whole_number(0, std::numeric_limits<std::int64_t>::max()));
  command.add_option("--participant", arguments->person, "number of the participant; overrides the experiment file")
      .type_name("N")
      .check(whole_number(1, 999'999));
  const Option fast =
      command.add_flag("--fast", arguments->as_fast_as_possible, "virtual clock: run as fast as possible");
  command.add_option("--speed", arguments->speed, "virtual clock: run X times faster than real time")
      .type_name("X")
      .check(positive())
      .excludes(fast);
  add_readers_option(command, arguments->readers);
  command.add_flag("--dry-run", arguments->dry_run, "print what would be done; nothing moves");
  command.add_flag("!--no-measure", arguments->measure, "record without measuring");
  command.add_flag("--quiet", arguments->quiet, "no status line");
  add_console_options(command, arguments->console);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
