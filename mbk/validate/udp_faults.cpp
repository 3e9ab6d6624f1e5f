#include "mbk/validate/udp_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "mbk/base/core/words.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/base/system/child_process.h"
#include "mbk/base/system/temporary_folder.h"
#include "mbk/experiment/safety/gate.h"
#include "mbk/files/recording/read.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/udp_fault_kinds.h"

namespace mbk::validation {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr unsigned kSideBySide = 4;
constexpr double kPerturbed = 4.0;   // [s], of a trial with a fault
constexpr double kMovingIn = 0.9;    // soft start, move and rest: then it is perturbed [s]
constexpr double kTrial = 5.4;       // all of it [s]
constexpr double kFaultFree = 60.0;  // perturbed in a trial without a fault [s]
constexpr int kFaultFreeTrials = 3;  // of a run
/// Of a trial of forces without a fault [N]. With the 6 N of the others this arm is 80 mm from home within an hour,
/// where the stop is right.
constexpr double kFaultFreeForce = 4.0;
constexpr int kAttempts = 5;         // of a run with a fault, where a recorded stall ends the trial first
constexpr double kPatience = 30.0;   // for a program beyond its trial [s]
constexpr double kStall = 0.005;     // between two ticks of the loop, or missed in a row by the robot [s]
constexpr double kBefore = 1.0;      // a stall explains a trip for so long [s]
constexpr int kNotConfirmedOff = 7;  // exit code of `mbk run`
constexpr double kHandSpeed = 0.4;   // with a flipped sign, trial of positions [m/s]

/// What a stall of the loop, the link or the robot's program may look like from the other side.
constexpr std::array<std::string_view, 12> kOfStalls = {"late",
                                                        "link-lost",
                                                        "answer-late",
                                                        "state-old",
                                                        "robot-clock",
                                                        "robot-watchdog",
                                                        "motors-off",
                                                        "encoder-jump",
                                                        "force-jump",
                                                        "tracking",
                                                        "accelerometer-disagrees",
                                                        "acceleration"};

constexpr std::array kTrialKinds = {TrialKind::position, TrialKind::force};

/// A robot's time line, from the last line of its log that says so; ticks.
struct Truth {
  std::int64_t ticks = 0, motors_on = -1, fault_began = -1, told_off = -1, torque_off = -1;
  double speed = 0.0, force = 0.0;
  struct Stall {
    std::int64_t tick, ticks;
  };
  std::vector<Stall> stalls;
  bool gone = false;  ///< its program was, so that nobody heard what it was told
  bool ended = false;
};

/// What `mbk run` says of itself.
struct Said {
  int exit_code = -1;
  std::string trip;          ///< code; empty: none
  bool confirmed = false;    ///< the motors are off
  bool unconfirmed = false;  ///< loudly
  double gap = 0.0;          ///< longest between two ticks of the last second [s]
  double duration = 0.0;     ///< of the recording [s]
  std::string output;
};

struct Job {
  const UdpFaultKind* kind;  // null: nothing breaks
  TrialKind trial;
  int run;
};

/// Of one job.
struct FaultOutcome {
  Truth truth;
  Said said;
  std::int64_t ticks = -1;  ///< from the fault to motors that are off, or told to be; −1: never
  bool began = false;       ///< the fault did
  bool stalled = false;     ///< a recorded stall of loop or robot lies before the stop
};

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The lines that are whole.
Truth read_truth(const fs::path& log) {
  Truth truth;
  std::istringstream lines(text_of(log));
  for (std::string line; std::getline(lines, line) && !lines.eof();) {
    const Json event = Json::parse(line, nullptr, false);
    if (!event.is_object() || !event.contains("tick")) continue;
    truth.ticks = event.value("tick", std::int64_t{0});
    truth.motors_on = event.value("motors_on", std::int64_t{-1});
    truth.fault_began = event.value("fault_began", std::int64_t{-1});
    truth.told_off = event.value("told_off", std::int64_t{-1});
    truth.torque_off = event.value("torque_off", std::int64_t{-1});
    truth.speed = event.value("speed_m_per_s", 0.0);
    truth.force = event.value("force_N", 0.0);
    const std::string name = event.value("event", "");
    if (name == "stall") truth.stalls.push_back({truth.ticks, event.value("stalled", std::int64_t{0})});
    truth.gone = truth.gone || name == "gone";
    truth.ended = truth.ended || name == "end";
  }
  return truth;
}

/// Where the robot listens, once it does.
std::optional<int> port_of(const fs::path& log) {
  const std::string text = text_of(log);
  const Json event = Json::parse(text.substr(0, text.find('\n')), nullptr, false);
  if (!event.is_object() || !event.contains("port")) return std::nullopt;
  return event.value("port", 0);
}

template <class Done>
bool wait_until(const Done& done, double longest) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest);
  while (!done()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

Said read_said(const fs::path& output, const fs::path& target, int exit_code) {
  Said said;
  said.exit_code = exit_code;
  said.output = text_of(output);
  said.confirmed = said.output.find("motors: confirmed off") != std::string::npos;
  said.unconfirmed = exit_code == kNotConfirmedOff && said.output.find("MOTORS NOT CONFIRMED OFF") != std::string::npos;
  const auto recording = recording::read(target, {});
  if (!recording) return said;
  const auto& metadata = recording->metadata;
  if (const auto trip = metadata.find("trip"); trip != metadata.end()) said.trip = trip->second;
  const Vector& time = recording->time;
  said.duration = time.size() > 0 ? time[time.size() - 1] - time[0] : 0.0;
  for (Index i = time.size() - 1; i > 0 && time[i] > time[time.size() - 1] - kBefore; --i) {
    said.gap = std::max(said.gap, time[i] - time[i - 1]);
  }
  return said;
}

/// When the fault begins after the motors are on [s].
double draw_moment(const Job& job, numeric::Random& random) {
  if (job.kind == nullptr) return 0.0;
  const double detection = 1e-3 * job.kind->detection[static_cast<std::size_t>(job.trial)];
  // What takes its time to be found needs a hand that moves meanwhile.
  const double first = detection > 0.3 ? kMovingIn : 0.15;
  const double last = kMovingIn + kPerturbed - std::max(detection, 0.5);
  return random.uniform(first, std::max(first + 0.3, last));
}

class Runner {
 public:
  Runner(const UdpFaultsOptions& options, fs::path folder)
      : options_(&options),
        folder_(std::move(folder)),
        robot_(options.program.parent_path() / "mbk_misbehaving_robot") {}

  [[nodiscard]] Result<FaultOutcome> perform(const Job& job, int number) const {
    const std::uint64_t seed = 100'000 * options_->study.seed + static_cast<std::uint64_t>(number);
    numeric::Random random(seed);
    const auto file = [&](const char* ending) { return folder_ / fmt::format("{}{}", number, ending); };
    const double perturbed = job.kind == nullptr ? kFaultFree : kPerturbed;
    const std::string experiment = (job.kind == nullptr ? fault_experiment(job.trial, perturbed, 1.0, kFaultFreeForce)
                                                        : fault_experiment(job.trial, perturbed, 1.0)) +
                                   "[session]\nsoft_start_s = 0.3\nshortest_move_s = 0.3\nsettle_s = 0.2\n";
    std::ofstream(file("-robot.toml")) << experiment;
    const double moment = draw_moment(job, random);
    const bool key = job.kind != nullptr && job.kind->expected == Expected::at_stop && job.run / 2 % 2 == 1;

    std::vector<std::string> command = {robot_.string(), file("-robot.toml").string(), "--port", "0",
                                        "--seed",        std::to_string(seed),         "--for",  "150"};
    if (job.kind != nullptr) {
      const double armed = job.kind->expected == Expected::at_stop ? std::min(moment, kMovingIn) : moment;
      for (const std::string& one :
           {std::string("--fault"), std::string(job.kind->name), std::string("--at"), fmt::format("{:.3f}", armed)}) {
        command.push_back(one);
      }
    } else if (job.run % 2 == 1) {
      command.insert(command.end(), {"--version", "2"});
    }
    auto robot = MBK_TRY(system::ChildProcess::start(command, file("-robot.log")));
    if (!wait_until([&] { return port_of(file("-robot.log")).has_value(); }, kPatience)) {
      return bad_data("the robot does not listen: " + text_of(file("-robot.log")), "", command.front());
    }
    std::ofstream(file(".toml")) << experiment << "[device]\nkind = \"udp\"\nforce_latency_ticks = 1\nport = "
                                 << port_of(file("-robot.log")).value_or(0) << "\n";
    auto mbk = MBK_TRY(system::ChildProcess::start({options_->program.string(), "run", file(".toml").string(),
                                                    "--no-measure", "--quiet", "--out", file(".h5").string()},
                                                   file(".log")));
    if (key) {
      // Somebody stops the trial.
      wait_until([&] { return read_truth(file("-robot.log")).motors_on >= 0; }, kPatience);
      std::this_thread::sleep_for(std::chrono::duration<double>(std::max(moment, kMovingIn + 0.1)));
      mbk.send(system::Signal::interrupt);
    }
    const auto code = mbk.wait(kTrial - kPerturbed + perturbed + kPatience);
    // What the motors do once nobody is there any more.
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    robot.send(system::Signal::terminate);
    if (!robot.wait(kPatience)) return bad_data("the robot's program does not end", "", command.front());

    FaultOutcome outcome;
    outcome.truth = read_truth(file("-robot.log"));
    if (!outcome.truth.ended) {
      return bad_data("the robot's log has no last line: " + text_of(file("-robot.log")), "", command.front());
    }
    outcome.said = read_said(file(".log"), file(".h5"), code.value_or(-1));
    outcome.began = outcome.truth.fault_began >= 0;
    judge_time(outcome);
    for (const char* ending : {"-robot.toml", "-robot.log", ".toml", ".h5", ".log", ".h5.journal"}) {
      std::error_code ignored;
      fs::remove(file(ending), ignored);
    }
    return outcome;
  }

 private:
  static void judge_time(FaultOutcome& outcome) {
    const Truth& truth = outcome.truth;
    std::int64_t stop = truth.gone ? truth.torque_off : truth.told_off;
    if (truth.torque_off >= 0 && (stop < 0 || truth.torque_off > stop)) stop = truth.torque_off;
    if (outcome.began && stop >= 0) outcome.ticks = std::max<std::int64_t>(0, stop - truth.fault_began);
    const std::int64_t end = stop >= 0 ? stop : truth.ticks;
    outcome.stalled = outcome.said.gap >= kStall || std::ranges::any_of(truth.stalls, [&](const Truth::Stall& stall) {
                        return stall.tick <= end + 50 && stall.tick >= end - static_cast<std::int64_t>(1e3 * kBefore);
                      });
  }

  const UdpFaultsOptions* options_;
  fs::path folder_, robot_;
};

/// What a run with a fault comes to.
enum class Verdict { in_time, late, not_recognised, wrong_reason, stalled, never_began };
[[nodiscard]] constexpr auto word_table(Verdict) {
  using enum Verdict;
  return std::to_array<Word<Verdict>>({{in_time, "recognised in time"},
                                       {late, "recognised late"},
                                       {not_recognised, "NOT RECOGNISED"},
                                       {wrong_reason, "stopped for another reason"},
                                       {stalled, "explained by a recorded stall"},
                                       {never_began, "the fault never began"}});
}

enum class Safe { confirmed, loud, silently_wrong };

[[nodiscard]] constexpr auto word_table(Safe) {
  using enum Safe;
  return std::to_array<Word<Safe>>(
      {{confirmed, "confirmed off"}, {loud, "loudly not confirmed"}, {silently_wrong, "SILENTLY WRONG"}});
}

bool contains(const auto& list, std::string_view one) {
  return std::ranges::find(list, one) != list.end();
}

int documented(const UdpFaultKind& kind, TrialKind trial) {
  return kind.detection[static_cast<std::size_t>(trial)] + safety::kRampTicks + kLinkTicks;
}

Verdict verdict_of(const Job& job, const FaultOutcome& outcome) {
  const UdpFaultKind& kind = *job.kind;
  const Said& said = outcome.said;
  const bool tripped = !said.trip.empty();
  const bool right = contains(kind.reasons, said.trip);
  const bool of_stall = tripped && outcome.stalled && contains(kOfStalls, said.trip);
  if (!outcome.began) return of_stall ? Verdict::stalled : tripped ? Verdict::wrong_reason : Verdict::never_began;
  switch (kind.expected) {
    case Expected::trip:
      if (!tripped && !said.unconfirmed) return Verdict::not_recognised;
      if (!right) return of_stall ? Verdict::stalled : Verdict::wrong_reason;
      if (outcome.ticks >= 0 && outcome.ticks <= documented(kind, job.trial)) return Verdict::in_time;
      return outcome.stalled ? Verdict::stalled : Verdict::late;
    case Expected::at_stop:
      if (said.unconfirmed || kind.safe_state == SafeState::either) return Verdict::in_time;
      return of_stall ? Verdict::stalled : Verdict::not_recognised;
    case Expected::refusal:
      return outcome.truth.motors_on < 0 || right ? Verdict::in_time : Verdict::not_recognised;
    case Expected::no_harm:
    case Expected::not_detected:
      if (!tripped || right) return Verdict::in_time;
      return of_stall ? Verdict::stalled : Verdict::wrong_reason;
  }
  return Verdict::not_recognised;
}

Safe safe_state_of(const FaultOutcome& outcome) {
  if (outcome.said.unconfirmed) return Safe::loud;
  const bool off = outcome.truth.torque_off >= 0 || outcome.truth.motors_on < 0;
  const bool began = outcome.truth.motors_on >= 0;
  // Without a word the motors are not confirmed off, and nobody knows.
  return off && (outcome.said.confirmed || !began) ? Safe::confirmed : Safe::silently_wrong;
}

/// Exact two-sided 95 % interval of a Poisson mean: P(N ≥ n) = 0.025 at its lower end, P(N ≤ n) = 0.025 at the upper.
Range poisson_interval(int count) {
  const double low = count == 0 ? 0.0 : 0.5 * numeric::chi_square_quantile(0.025, 2 * count);
  return {low, 0.5 * numeric::chi_square_quantile(0.975, 2 * count + 2)};
}

class Summary {
 public:
  explicit Summary(ValidationTable& table) : table_(&table) {}

  void add(const Job& job, const FaultOutcome& outcome) {
    job.kind == nullptr ? add_free(job, outcome) : add_fault(job, outcome);
  }

  void finish() {
    if (faults_ > 0) {
      table_->rows.push_back(
          share_row("recognised within the documented ticks, for a right reason", in_time_, judged_, kAlways));
      table_->rows.push_back(share_row("motors confirmed off, or loudly not", safe_, faults_, kAlways));
      table_->rows.push_back(exact_row("silently wrong about the motors", faults_ - safe_, Range{0.0, 0.0}, "runs"));
      table_->rows.push_back(
          exact_row("confirmed with a torque below torque_error_Nm left, as documented", unresolved_, {}, "runs"));
      for (const auto& [what, verdict] :
           {std::pair{"recognised late", Verdict::late}, std::pair{"stopped for another reason", Verdict::wrong_reason},
            std::pair{"not recognised", Verdict::not_recognised}}) {
        table_->rows.push_back(exact_row(what, verdicts_[static_cast<std::size_t>(verdict)], Range{0.0, 0.0}, "runs"));
      }
      table_->rows.push_back(exact_row("ended by a recorded stall, counted apart and tried again",
                                       verdicts_[static_cast<std::size_t>(Verdict::stalled)], {}, "runs"));
      table_->rows.push_back(exact_row("trial over before the fault began",
                                       verdicts_[static_cast<std::size_t>(Verdict::never_began)], {}, "runs"));
    }
    if (flipped_ >= 0.0) {
      table_->rows.push_back(
          exact_row("hand speed with a flipped sign, trial of positions", flipped_, Range{0.0, kHandSpeed}, "m/s"));
    }
    if (free_ > 0) {
      const double hours = seconds_ / 3600.0;
      table_->rows.push_back(
          exact_row(fmt::format("trips in {:.1f} min without a fault", seconds_ / 60.0), trips_, Range{0.0, 0.0}, ""));
      ValidationRow hourly = exact_row("trips in an hour without a fault", trips_ / hours, Range{0.0, 3.75}, "");
      const auto [low, high] = poisson_interval(trips_);
      hourly.interval95 = {low / hours, high / hours};
      table_->rows.push_back(std::move(hourly));
      table_->rows.push_back(exact_row("of a recorded stall, counted apart", stalls_, {}, ""));
      table_->rows.push_back(exact_row("without a word about the motors", silent_, Range{0.0, 0.0}, "trials"));
    }
  }

 private:
  void add_fault(const Job& job, const FaultOutcome& outcome) {
    const UdpFaultKind& kind = *job.kind;
    const Verdict verdict = verdict_of(job, outcome);
    const Safe safe = safe_state_of(outcome);
    ++faults_;
    ++verdicts_[static_cast<std::size_t>(verdict)];
    const bool apart = verdict == Verdict::stalled || verdict == Verdict::never_began;
    if (!apart) {
      ++judged_;
      in_time_ += verdict == Verdict::in_time ? 1 : 0;
    }
    const bool unresolved = kind.safe_state == SafeState::unresolved && outcome.said.confirmed;
    unresolved_ += unresolved && safe == Safe::silently_wrong ? 1 : 0;
    safe_ += safe == Safe::silently_wrong && !unresolved ? 0 : 1;
    if (job.kind->name == "sign-flipped" && job.trial == TrialKind::position) {
      flipped_ = std::max(flipped_, outcome.truth.speed);
    }
    add_row(job, outcome, apart);
    const bool expected_word =
        kind.safe_state == SafeState::either || (kind.safe_state == SafeState::confirmed) == (safe == Safe::confirmed);
    const bool right = verdict == Verdict::in_time || verdict == Verdict::stalled;
    if (!right || (safe == Safe::silently_wrong && !unresolved) || (verdict == Verdict::in_time && !expected_word)) {
      table_->notes.push_back(fmt::format(
          "{}, {} trial, run {}: {}; after {} ticks (documented {}), {}, exit code {}, motors {}{}, {:.2f} m/s, {:.1f} "
          "N",
          kind.name, word_of(job.trial), job.run, word_of(verdict), outcome.ticks, documented(kind, job.trial),
          outcome.said.trip.empty() ? "no trip" : outcome.said.trip, outcome.said.exit_code, word_of(safe),
          outcome.truth.torque_off >= 0 ? "" : " and on", outcome.truth.speed, outcome.truth.force));
    }
  }

  /// One for each kind and trial: the slowest.
  void add_row(const Job& job, const FaultOutcome& outcome, bool apart) {
    if (job.kind->expected != Expected::trip) return;
    const std::string what = fmt::format("{}, {} trial: off after", job.kind->name, word_of(job.trial));
    auto row = std::ranges::find(table_->rows, what, &ValidationRow::what);
    if (row == table_->rows.end()) {
      if (apart) return;
      table_->rows.push_back(exact_row(what, 0.0, Range{0.0, documented(*job.kind, job.trial)}, "ticks"));
      row = table_->rows.end() - 1;
    }
    if (apart) return;
    const double ticks = outcome.ticks >= 0 ? static_cast<double>(outcome.ticks) : 1e3 * kTrial;
    row->value = std::max(row->value, ticks);
  }

  void add_free(const Job& job, const FaultOutcome& outcome) {
    ++free_;
    seconds_ += outcome.said.duration;
    const Safe safe = safe_state_of(outcome);
    silent_ += safe == Safe::silently_wrong ? 1 : 0;
    const bool tripped = !outcome.said.trip.empty() || outcome.said.exit_code != 0;
    if (!tripped) return;
    const bool explained = outcome.stalled && contains(kOfStalls, outcome.said.trip);
    ++(explained ? stalls_ : trips_);
    table_->notes.push_back(fmt::format("without a fault, {} trial {}: {}{}, exit code {}, after {:.1f} s, motors {}",
                                        word_of(job.trial), job.run, outcome.said.trip,
                                        explained ? " by a recorded stall" : "", outcome.said.exit_code,
                                        outcome.said.duration, word_of(safe)));
  }

  ValidationTable* table_;
  std::array<int, 6> verdicts_{};
  int unresolved_ = 0, faults_ = 0, judged_ = 0, in_time_ = 0, safe_ = 0, free_ = 0, trips_ = 0, stalls_ = 0,
      silent_ = 0;
  double seconds_ = 0.0, flipped_ = -1.0;
};

Result<std::vector<const UdpFaultKind*>> kinds_of(const UdpFaultsOptions& options) {
  std::vector<const UdpFaultKind*> kinds;
  for (const std::string& name : options.faults) {
    const UdpFaultKind* kind = find_udp_fault(name);
    if (kind == nullptr) return bad_usage(fmt::format("there is no fault '{}'", name), "--list names them");
    kinds.push_back(kind);
  }
  if (kinds.empty()) {
    for (const UdpFaultKind& kind : udp_fault_kinds()) kinds.push_back(&kind);
  }
  return kinds;
}

}  // namespace

Result<ValidationTable> udp_faults_study(const UdpFaultsOptions& options) {
  const int runs = options.study.runs;
  if (runs < 1) return bad_usage(fmt::format("{} runs are too few", runs), "pass --runs 20");
  const auto kinds = MBK_TRY(kinds_of(options));
  const auto folder = MBK_TRY(TemporaryFolder::create("mbk-udp-faults"));

  std::vector<Job> jobs;
  for (const UdpFaultKind* kind : kinds) {
    for (int run = 0; run < runs; ++run) jobs.push_back({kind, kTrialKinds[static_cast<std::size_t>(run % 2)], run});
  }
  for (int run = 0; options.faults.empty() && run < kFaultFreeTrials * runs; ++run) {
    jobs.push_back({nullptr, kTrialKinds[static_cast<std::size_t>(run / 2 % 2)], run});
  }
  const Runner runner(options, folder.path());
  std::vector<std::vector<FaultOutcome>> outcomes(jobs.size());  // all attempts
  const auto count = static_cast<int>(jobs.size());
  int done = 0;
  MBK_TRY(numeric::parallel_for(
      count, options.study.threads == 0 ? kSideBySide : options.study.threads,
      [&](int i) -> Result<void> {
        const auto at = static_cast<std::size_t>(i);
        const Job& job = jobs[at];
        for (int attempt = 0; attempt < kAttempts; ++attempt) {
          auto outcome = MBK_TRY(runner.perform(job, attempt * count + i));
          outcomes[at].push_back(std::move(outcome));
          if (job.kind == nullptr || verdict_of(job, outcomes[at].back()) != Verdict::stalled) break;
        }
        return {};
      },
      [&](int) {
        if (options.study.progress) options.study.progress(++done, count);
      }));

  ValidationTable table{"faults",
                        "a robot behind UDP misbehaves: is it detected in time, and is the report on its motors true?",
                        "ticks", runs, options.study.seed};
  Summary summary(table);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    for (const FaultOutcome& outcome : outcomes[i]) summary.add(jobs[i], outcome);
  }
  summary.finish();
  table.notes.push_back(fmt::format(
      "A tick is 1 ms of the robot's clock. Expected times are those of docs/guide/safety.md, with {} ticks "
      "of ramp and {} of the link.",
      safety::kRampTicks, kLinkTicks));
  return table;
}

}  // namespace mbk::validation
