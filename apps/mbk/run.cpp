#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <limits>
#include <memory>
#include <optional>

#include "apps/mbk/commands.h"
#include "apps/mbk/last_words.h"
#include "apps/mbk/messages.h"
#include "apps/mbk/option_checks.h"
#include "apps/mbk/output.h"
#include "apps/mbk/plan_text.h"
#include "apps/mbk/readers_option.h"
#include "apps/mbk/run_console.h"
#include "apps/mbk/scenario_argument.h"
#include "apps/mbk/stop_keys.h"
#include "apps/mbk/stop_signals.h"
#include "mbk/experiment/console/live_estimate.h"
#include "mbk/experiment/protocol/personal_data.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/session.h"
#include "mbk/files/recording/read.h"
#include "mbk/measure/preprocess/perturbation_only.h"
#include "mbk/present/report/text.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;
using protocol::Trial;
using session::Session;

constexpr int kSafetyStop = 5, kMotorsNotOff = 7;

struct Arguments {
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

Result<std::vector<Trial>> trials_of(const Arguments& arguments) {
  const auto text = read_scenario_text(arguments.experiment);
  if (!text) return tl::unexpected(text.error());
  auto trials = protocol::read_experiment(text->text, text->file, laboratory::read_simulation);
  if (!trials) return trials;
  std::vector<Trial> chosen;
  for (const std::string& name : arguments.trials) {
    const auto found = std::ranges::find(*trials, name, &Trial::name);
    if (found == trials->end()) {
      return bad_usage(fmt::format("there is no trial '{}'", name), "see the [[trial]] names in the file");
    }
    chosen.push_back(*found);
  }
  if (chosen.empty()) chosen = std::move(*trials);
  for (Trial& trial : chosen) {
    if (arguments.seed) trial.seed = *arguments.seed;
    if (arguments.person) trial.person.number = *arguments.person;
    if (arguments.readers) trial.readers = *arguments.readers;
  }
  return chosen;
}

/// relaxed.h5 → relaxed_NAME.h5 where there are several trials.
fs::path target_of(const Arguments& arguments, const Trial& trial, bool several) {
  const fs::path out = arguments.out.empty() ? fs::path(trial.protocol + ".h5") : arguments.out;
  if (!several) return out;
  return out.parent_path() / fmt::format("{}_{}{}", out.stem().string(), trial.name, out.extension().string());
}

/// One line on standard error, written over itself where that is a terminal; else one a second.
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
  std::string text = fmt::format("{}: {}", outcome.recording.string(), outcome.ended);
  if (!outcome.ending.detail.empty()) text += ": " + outcome.ending.detail;
  text += "\n  motors: " + safety::sentence(outcome.motors);
  text += fmt::format("\n  {} ticks, {} dropped; compute per tick: {}\n", outcome.times.ticks, outcome.ending.dropped,
                      time_text(outcome.times.compute));
  if (!pace.virtual_clock) {
    text += fmt::format("  lateness: {}; {} ticks missed\n", time_text(outcome.times.lateness), outcome.times.missed);
    text += fmt::format("  time between commands: {}\n", time_text(outcome.times.interval));
    if (!outcome.setup.refused.empty()) text += fmt::format("  {}\n", outcome.setup.refused);
  }
  return text;
}

/// What is wrong with the journal, which was kept then.
std::string damage_text(const session::TrialOutcome& outcome) {
  std::string text;
  for (const std::string& sentence : outcome.damage.sentences()) text += fmt::format("  ! {}\n", sentence);
  if (!text.empty()) text += fmt::format("  the journal is kept: {}\n", outcome.journal.string());
  return text;
}

int dry_run(const std::vector<Trial>& trials, const std::string& experiment) {
  for (const Trial& trial : trials) {
    const auto plan = session::make_plan(trial);
    if (!plan) return report_error(plan.error().in(experiment));
    const auto rehearsal = session::rehearse(trial);
    if (!rehearsal) return report_error(rehearsal.error().in(experiment));
    if (auto ok = Output().write(plan_text(trial, *plan, *rehearsal)); !ok) return report_error(ok.error());
    if (rehearsal->trip.reason != safety::Reason::none) return kSafetyStop;
  }
  return kFine;
}

/// Share of the force's variance that a model has to explain on every axis before nobody is asked to repeat [%].
constexpr double kPoor = 50.0;

/// What was measured in a trial, and whether it is worth repeating.
struct Measured {
  std::string text;
  bool poor = false;
};

Measured measure(const session::TrialOutcome& outcome, const Trial& trial, RunConsole& console) {
  auto recording = recording::read(outcome.recording, {});
  if (!recording) return {recording.error().line() + "\n", true};
  const Recording perturbed = preprocess::perturbation_only(std::move(*recording));
  const auto measured =
      console.measured(perturbed, console::across_missed_ticks(perturbed, trial.rate, measurement_options_of(trial)));
  if (!measured) return {fmt::format("not measured: {}\n", measured.error().line()), true};
  const Identification& identification = measured->identification;
  return {report::result_text(identification, std::nullopt),
          !identification.usable || identification.fit.vaf.minCoeff() < kPoor};
}

/// At a terminal. What was typed before the question is no answer to it.
bool ask(const char* question, const session::Signals& signals) {
  tcflush(STDIN_FILENO, TCIFLUSH);
  say("{} [y/N] ", question);
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!signals.end_session) {
    constexpr int kWait = 100;  // [ms]
    if (poll(&input, 1, kWait) <= 0) continue;
    std::array<char, 256> line{};
    const ssize_t came = read(STDIN_FILENO, line.data(), line.size());
    if (came < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    return came > 0 && (line[0] == 'y' || line[0] == 'Y');
  }
  return false;
}

/// What standard error did not take goes where it can still be read: to standard output, and into the recording.
std::string lost_messages_text(std::vector<std::string>& notes) {
  const LostMessages lost = take_lost_messages();
  if (lost.count == 0) return {};
  notes.push_back(
      fmt::format("{} message{} of mbk to standard error lost: {}", lost.count, lost.count == 1 ? "" : "s", lost.why));
  return fmt::format("  {}\n", notes.back());
}

/// relaxed.h5 → relaxed_2.h5, the first that is not there yet.
fs::path next_free(const fs::path& target) {
  fs::path free = target;
  std::error_code ignored;  // a name that cannot be looked at is refused where it is made
  for (int k = 2; fs::exists(free, ignored); ++k) {
    free = target.parent_path() / fmt::format("{}_{}{}", target.stem().string(), k, target.extension().string());
  }
  return free;
}

/// The loudest thing that this program says.
std::string alarm(const safety::MotorsOff& motors) {
  constexpr std::size_t kColumns = 78;  // any terminal's
  const std::string line(kColumns, '!');
  return fmt::format(
      "\a\n{0}\n!!  MOTORS NOT CONFIRMED OFF\n!!  Press the hardware stop button: cut the motors' power. Let nobody "
      "touch the robot.\n{0}\n{1}\n\n",
      line, report::wrapped("The motors are " + safety::sentence(motors) + ".", kColumns));
}

/// Whatever else went wrong.   @returns  whether there was reason to
bool sound_alarm(const Session& session) {
  const safety::Gate* const gate = session.gate();
  if (gate == nullptr || gate->motors().state != safety::MotorsOff::State::missing) return false;
  say("{}", alarm(gate->motors()));
  return true;
}

/// Exit code of a trial after which none follows; what is worst counts.
int code_of(const session::TrialOutcome& outcome) {
  if (outcome.motors.state == safety::MotorsOff::State::missing) return kMotorsNotOff;
  if (outcome.trip.reason != safety::Reason::none) return kSafetyStop;
  return outcome.incomplete ? kBadData : kFine;
}

/// One trial: on the robot, into the file, and measured.
/// @returns  an exit code where no trial may follow
std::optional<int> perform(Session& session, const Trial& trial, std::size_t index, const fs::path& target,
                           const session::Pace& pace, const Arguments& arguments, RunConsole& console, bool& repeat) {
  repeat = false;
  auto robot = protocol::make_device(trial);
  if (!robot) return report_error(robot.error());
  if (auto ok = console.begin(index, trial, (*robot)->facts(), target); !ok) return report_error(ok.error());
  session::Signals& signals = session.signals();
  std::optional<StopSignals::Trial> running(std::in_place);
  if (signals.end_session) return kFine;
  const auto outcome = [&] {
    const LastWords last_words(**robot);
    const StopKeys keys(signals);
    StatusLine line(trial.name, arguments.quiet);
    return session.perform(**robot, trial, target, [&](std::span<const journal::Tick> ticks) {
      line.show(ticks);
      console.watch(ticks);
    });
  }();
  running.reset();
  const bool alarming = sound_alarm(session);
  const auto failed = [&](const Error& error) {
    const int code = report_error(error);
    if (alarming) return kMotorsNotOff;
    return outcome && outcome->trip.reason != safety::Reason::none ? kSafetyStop : code;
  };
  if (!outcome) return failed(outcome.error());
  console.show_robot(outcome->motors);
  std::optional<session::IdleWatch> idle;
  if (!trial.device.simulated()) idle.emplace(**robot, console.watching(session));
  std::vector<std::string> notes;
  std::string text = outcome_text(*outcome, pace) + console.finish(*outcome) + lost_messages_text(notes);
  const bool stopped = outcome->trip.reason != safety::Reason::none;
  text += damage_text(*outcome);
  Measured measured;
  if (!stopped && arguments.measure && !signals.end_session) {
    measured = measure(*outcome, trial, console);
    text += measured.text;
  }
  const auto written = Output().write(text);
  if (!notes.empty()) {
    if (auto ok = session::annotate(outcome->recording, notes); !ok) return failed(ok.error());
  }
  if (auto ok = console.keep_notes(); !ok) return failed(ok.error());
  if (!written) return failed(written.error());
  if (outcome->incomplete) {
    report_error({ErrorKind::data, outcome->ended, "look at the disk before the next trial; the journal is kept",
                  target.string()});
    return code_of(*outcome);
  }
  if (signals.end_session) return code_of(*outcome);
  if (console.decides(stopped || measured.poor)) {
    const auto then = console.after_trial(session, stopped);
    repeat = then == AfterTrial::repeat;
    if (then == AfterTrial::end) return code_of(*outcome);
    return std::nullopt;
  }
  const bool terminal = isatty(STDIN_FILENO) == 1;
  if (stopped) {
    if (!terminal) return code_of(*outcome);
    while (!repeat) {
      if (!ask("Is the reason gone? Reset the gate and do the trial again?", signals)) return code_of(*outcome);
      if (auto ok = session.reset(); !ok) {
        report_error(ok.error());
      } else {
        repeat = true;
      }
    }
  } else if (measured.poor && terminal) {
    repeat = ask("The data are poor. Do the trial again?", signals);
  } else if (measured.poor) {
    say("mbk: the data of {} are poor; think of repeating the trial\n", target.string());
  }
  return std::nullopt;
}

/// @returns  the exit code, where no signal ended the session outside of a trial
int perform_all(Session& session, const std::vector<Trial>& trials, const session::Pace& pace,
                const Arguments& arguments) {
  auto console = RunConsole::open(arguments.console, trials, session.signals());
  if (!console) return report_error(console.error());
  if (!console->may_begin(session, trials.front())) return kFine;
  std::optional<int> code;
  for (std::size_t index = 0; index < trials.size() && !code; ++index) {
    const fs::path target = target_of(arguments, trials[index], trials.size() > 1);
    for (bool repeat = true; repeat && !code && !session.signals().end_session;) {
      code = perform(session, trials[index], index, next_free(target), pace, arguments, *console, repeat);
    }
  }
  if (auto ok = console->end(); !ok) return report_error(ok.error());
  return code.value_or(kFine);
}

int run(const Arguments& arguments) {
  const auto trials = trials_of(arguments);
  if (!trials) return report_error(trials.error());
  for (const std::string& warning : protocol::personal_warnings(*trials)) {
    say("mbk: {}: warning: {}\n", arguments.experiment, warning);
  }
  if (arguments.dry_run) return dry_run(*trials, arguments.experiment);
  session::Pace pace;
  pace.virtual_clock = arguments.as_fast_as_possible || arguments.speed.has_value();
  pace.speed = arguments.speed.value_or(0.0);
  for (const Trial& trial : *trials) {
    if (auto plan = session::make_plan(trial); !plan) return report_error(plan.error().in(arguments.experiment));
    const fs::path target = target_of(arguments, trial, trials->size() > 1);
    if (std::error_code ignored; fs::exists(target, ignored)) {
      return report_error(
          {ErrorKind::usage, "is there already", "choose another --out, or move it away", target.string()});
    }
  }
  Session session(pace);
  int code = kFine, ended_by = 0;
  {
    const StopSignals signals(session.signals());
    const BackgroundMessages messages;
    code = perform_all(session, *trials, pace, arguments);
    ended_by = signals.ended_by();
  }
  if (ended_by != 0 && code == kFine) end_by(ended_by);
  return code;
}

}  // namespace

Action add_run(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = add_command(app, "run", "run an experiment at 1 kHz: perturb, record, measure");
  command->footer(
      "Examples:\n"
      "  mbk run relaxed_sinusoidal --out relaxed.h5\n"
      "      a simulated robot and participant, in real time; needs nothing\n"
      "  mbk run mine.toml --dry-run\n"
      "      schedule, peaks, duration and limits, before anyone sits down\n"
      "  mbk run mine.toml --participant 7 --out p07.h5\n"
      "      every [[trial]] of the file in turn: p07_NAME.h5\n"
      "  mbk run relaxed_sinusoidal --fast --out relaxed.h5\n"
      "      the same on a virtual clock, as fast as the machine can; --speed 20 for twenty times\n"
      "  mbk run mine.toml --wait\n"
      "      nothing moves before its operator says so in the console, a page whose address is printed\n\n"
      "The space bar and Ctrl-C stop the robot, e ends a trial early. What is recorded goes to\n"
      "NAME.h5.journal first; where the program or the machine went down, 'mbk recover' makes a recording of it.\n"
      "The gate limits force, torque, speed and place in software; it is no certified safety function. With people,\n"
      "a stop button that cuts the motors' power stays necessary (docs/guide/run.md).\n"
      "Exit codes: 0 fine, 2 wrong usage, 3 bad or unreadable data, or ticks were lost, 4 computed but not usable,\n"
      "5 safety stop, 7 the robot did not confirm that its motors are off: cut their power.");
  command->add_option("EXPERIMENT", arguments->experiment, "a .toml file, or the name of a ready one")
      ->required()
      ->check(suggests(ready_scenario_names()));
  command->add_option("--out", arguments->out, "the recording to write (NAME.h5); several trials get suffixes")
      ->type_name("REC")
      ->check(not_empty());
  command->add_option("--trial", arguments->trials, "only this [[trial]] of the file; may be repeated")
      ->type_name("NAME");
  command->add_option("--seed", arguments->seed, "of phases, decisions and noise, instead of the experiment's")
      ->type_name("N")
      ->check(whole_number(0, std::numeric_limits<long>::max()));
  command->add_option("--participant", arguments->person, "number of the person, instead of the file's")
      ->type_name("N")
      ->check(whole_number(1, 999'999));
  command->add_flag("--fast", arguments->as_fast_as_possible, "virtual clock: as fast as the machine can");
  command->add_option("--speed", arguments->speed, "virtual clock: so many seconds for each second")->type_name("X");
  add_readers_option(*command, arguments->readers);
  command->add_flag("--dry-run", arguments->dry_run, "say what would be done; nothing moves");
  command->add_flag("!--no-measure", arguments->measure, "record only");
  command->add_flag("--quiet", arguments->quiet, "no status line");
  add_console_options(*command, arguments->console);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
